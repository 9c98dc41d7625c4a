"""The schema of a robot's YAML file.

The schema, its defaults, which are Atlas' values, and the checks of the file alone.
Consistency of file and URDF is checked in ``fit``.
"""

# Annotations must be types, not strings: docs/make_reference.py reads them.
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from annotated_types import Len, MinLen

from atlas_drake.config import Configuration, NotNegative, Positive, Vector
from atlas_drake.errors import ScenarioError
from atlas_drake.units import (
    Meters,
    NewtonMeterSecondsPerRadian,
    NewtonMetersPerRadian,
    Radians,
)

LEGS = ("l_leg", "r_leg")
"""Limbs in the order of foot indices."""
LIMBS = ("back", "neck", *LEGS, "l_arm", "r_arm", "l_hand", "r_hand")
TRUNK = "trunk"
"""Name that means the link of ``chest`` in pushes of every robot."""
Name = Annotated[str, MinLen(1)]
"""A name that must be given."""


@dataclass(frozen=True, kw_only=True)
class JointEntry(Configuration):
    """One actuated joint, in message order."""

    name: Name
    """Name in the URDF."""
    alias: str = ""
    """Second name of the joint for users; for Atlas' joints the name in its first
    version."""
    limb: Literal[
        "back", "neck", "l_leg", "r_leg", "l_arm", "r_arm", "l_hand", "r_hand"
    ]
    """Limb of the joint: back, neck, l_leg, r_leg, l_arm, r_arm, l_hand or r_hand."""
    kp: NotNegative[NewtonMetersPerRadian] = 0.0
    """Default position gain in force before any command."""
    kd: NotNegative[NewtonMeterSecondsPerRadian] = 0.0
    """Default derivative gain in force before any command."""
    stand_prep: Radians = 0.0
    """Position in the stand-prep pose, from which STAND can begin."""


@dataclass(frozen=True, kw_only=True)
class FootEntry(Configuration):
    """One foot: its body and the frame in which footsteps are commanded."""

    body: Name
    """Name in the URDF."""
    sole_frame: Name
    """Frame at the center of the sole on its bottom plane, x ahead, z along the
    normal."""


@dataclass(frozen=True, kw_only=True)
class SoleSize(Configuration):
    """Contact rectangle of each sole."""

    length: Positive[Meters]
    """Size along the sole's x."""
    width: Positive[Meters]
    """Size along the sole's y."""


@dataclass(frozen=True, kw_only=True)
class ContactEntry(Configuration):
    """A surface of the robot, beside the soles, that can carry load."""

    name: Name
    """Name of the contact for tasks and behaviors."""
    frame: Name
    """Frame or body F of the URDF that the surface belongs to."""
    p_FC: Vector[Meters] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Center of the surface in F."""
    rpy_FC: Vector[Radians] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Roll, pitch and yaw of the contact frame C in F; z of C points from the touched
    object into the robot, as a sole's does."""
    length: Positive[Meters]
    """Size of the contact rectangle along x of C."""
    width: Positive[Meters]
    """Size of the contact rectangle along y of C."""


@dataclass(frozen=True, kw_only=True)
class RobotFile(Configuration):
    """The schema of a robot's YAML file."""

    urdf: Name
    """URDF file, relative to this one, or ``package://NAME/...``: in the package above
    this file, in one of ROS_PACKAGE_PATH, or in drake_models, which Drake fetches."""
    pelvis: Name
    """Body at the top of both legs, free in the world."""
    chest: Name
    """Body or frame that balance keeps upright; the pelvis itself for a robot without a
    back. Pushes know its body as ``trunk``."""
    hands: list[str] = field(default_factory=list)
    """Bodies of the left and the right hand; none for a robot without hands."""
    palms: list[Vector[Meters]] = field(default_factory=list)
    """Point of either hand that goes where the hand is told, in its body's frame [m];
    the hand points from the body's origin there. Centers of mass if left out."""
    imu_frame: str = ""
    """Frame of the inertial sensor; the pelvis if left out."""
    feet: list[FootEntry]
    """Left foot, right foot: the order of foot_index."""
    sole: SoleSize
    """Contact rectangle of each sole."""
    contacts: list[ContactEntry] = field(default_factory=list)
    """Further surfaces that can carry load, such as hands."""
    pushed: list[str] = field(default_factory=list)
    """Bodies that the cockpit names for pushes; pelvis, trunk and hands if left out."""
    joints: list[JointEntry] = field(default_factory=list)
    """Every actuated joint in the order of the messages' arrays."""
    no_collisions: list[Annotated[list[str], Len(2, 2)]] = field(default_factory=list)
    """Pairs of bodies of the URDF whose shapes do not touch each other, such as
    ``[[hips, left_thigh]]``. Neighbors in the tree never do."""
    least_knee_flexion: NotNegative[Radians] = 0.30
    """Least flexion of the knee, from the straight leg: a nearly straight leg loses
    control of the height."""
    most_knee_flexion: NotNegative[Radians] = 1.9
    """Greatest flexion of the knee, from the straight leg, with the sole level: beyond
    it the ankle reaches its end stop and the leg lifts the body."""
    scaled: bool = True
    """Whether the controller's defaults, which are Atlas' values, scale with the mass,
    the height, the soles and the hips of the robot."""
    controller: dict[str, Any] = field(default_factory=dict)
    """The robot's values of the scenario's field ``controller``, at the same paths,
    such as ``{walk: {limits: {forward: 0.30}}}``; a scenario overrides them."""

    def check(self) -> None:
        """Checks what the fields' types do not express."""
        if len(self.hands) not in (0, 2):
            problem = "must be the left and the right hand, or []"
            raise ScenarioError.about("hands", self.hands, problem)
        if len(self.palms) not in (0, len(self.hands)) or not all(map(any, self.palms)):
            problem = "must be one point for each of the hands, not [0, 0, 0], or []"
            raise ScenarioError.about("palms", self.palms, problem)
        if len(self.feet) != 2:
            problem = "must be two: the left and the right foot"
            raise ScenarioError.about("feet", self.feet, problem)
        for path, entries in {
            "joints": [[one.name, one.alias] for one in self.joints],
            "contacts": [[one.name] for one in self.contacts],
        }.items():
            known: set[str] = set()
            for index, names in enumerate(entries):
                if known & set(names):
                    problem = "has a name of an earlier one"
                    raise ScenarioError(f"{path}[{index}].name", names[0], problem)
                known |= set(filter(None, names))
        if self.most_knee_flexion < self.least_knee_flexion:
            problem = f"must be at least {self.least_knee_flexion:g}"
            most = self.most_knee_flexion
            raise ScenarioError.about("most_knee_flexion", most, problem)
