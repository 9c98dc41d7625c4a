"""The schema of a robot's YAML file.

The schema, its defaults, which are Atlas' values, and the checks of the file alone.
Consistency of file and URDF is checked in ``fit``.
"""

# Annotations must be types, not strings: docs/make_reference.py reads them.
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Len, MinLen

from atlas_drake.configuration import (
    Configuration,
    NotNegative,
    Positive,
    ProperShare,
    Vector,
)
from atlas_drake.errors import ScenarioError, shown

LEGS = ("l_leg", "r_leg")
"""Limbs in the order of foot indices."""
LIMBS = ("back", "neck", *LEGS, "l_arm", "r_arm")
Name = Annotated[str, MinLen(1)]
"""A name that must be given."""
Range = Annotated[list[float], Len(2, 2)]
"""A least and a greatest value."""


@dataclass(frozen=True, kw_only=True)
class JointEntry(Configuration):
    """One actuated joint, in message order."""

    name: Name
    """Name in the URDF."""
    alias: str = ""
    """Second name of the joint for users; for Atlas' joints the name in its first
    version."""
    limb: Literal["back", "neck", "l_leg", "r_leg", "l_arm", "r_arm"]
    """Limb of the joint: back, neck, l_leg, r_leg, l_arm or r_arm."""
    kp: NotNegative = 0.0
    """Default position gain in force before any command [N·m/rad]."""
    kd: NotNegative = 0.0
    """Default derivative gain in force before any command [N·m·s/rad]."""
    stand_prep: float = 0.0
    """Position in the stand-prep pose, from which STAND can begin [rad]."""


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

    length: Positive
    """Size along the sole's x [m]."""
    width: Positive
    """Size along the sole's y [m]."""


@dataclass(frozen=True, kw_only=True)
class ContactEntry(Configuration):
    """A surface of the robot, beside the soles, that can carry load."""

    name: Name
    """Name of the contact for tasks and behaviors."""
    frame: Name
    """Frame or body F of the URDF that the surface belongs to."""
    p_FC: Vector = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Center of the surface in F [m]."""
    rpy_FC: Vector = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Roll, pitch and yaw of the contact frame C in F [rad]; z of C points from the
    touched object into the robot, as a sole's does."""
    length: Positive
    """Size of the contact rectangle along x of C [m]."""
    width: Positive
    """Size of the contact rectangle along y of C [m]."""


@dataclass(frozen=True, kw_only=True)
class StepLimits(Configuration):
    """Limits of one step relative to the stance foot.

    Lateral distances and turns are positive away from the stance foot: a left foot
        turns its toes to the left.
    """

    forward: NotNegative = 0.42
    """Longest step ahead [m]."""
    backward: NotNegative = 0.32
    """Longest step back [m]."""
    min_width: NotNegative = 0.18
    """Least lateral distance between the feet, center to center [m]."""
    max_width: NotNegative = 0.50
    """Greatest lateral distance between the feet, center to center [m]."""
    rise: NotNegative = 0.10
    """Largest step up or down [m]."""
    meant_rise: NotNegative = 0.40
    """Heights farther than this from the stance foot are treated as not given [m]: on
    level ground a step may have the height of the pelvis."""
    tilt: NotNegative = 0.30
    """Steepest slope of the ground at a foothold [rad]."""
    toe_out: NotNegative = 0.5
    """Largest turn outward [rad]."""
    toe_in: NotNegative = 0.25
    """Largest turn inward [rad]."""
    min_duration: Positive = 0.60
    """Shortest duration of a step [s]."""
    max_duration: NotNegative = 3.0
    """Longest duration of a step from and to a place near the other foot [s]."""
    near: NotNegative = 0.40
    """Distance of the feet up to which a step may take the longest duration [m]."""
    far: NotNegative = 0.60
    """Distance of the feet from which a step takes ``far_duration`` at most [m]."""
    far_duration: NotNegative = 1.0
    """Longest duration of a step with the feet far apart [s]: in a slower step the
    center of mass would have to be over the stance foot while the other leg cannot
    reach."""
    min_swing_height: NotNegative = 0.03
    """Lowest apex of a swing above the middle of its ends [m]."""
    max_swing_height: NotNegative = 0.30
    """Highest apex of a swing above the middle of its ends [m]."""

    def check(self) -> None:
        """Checks that the limits leave a range."""
        for names in (
            ("min_width", "max_width"),
            ("min_duration", "far_duration", "max_duration"),
            ("near", "far"),
            ("min_swing_height", "max_swing_height"),
        ):
            _check_order(self, names)
        if self.near == self.far:
            raise _wrong("far", self.far, "must be more than near")


def quasi_static_limits() -> StepLimits:
    """Returns the default limits of STEP; slow steps may be larger than a walk's."""
    return StepLimits(
        forward=0.42,
        backward=0.36,
        max_width=0.45,
        rise=0.20,
        tilt=0.25,
        min_duration=0.1,
        max_duration=20.0,
        min_swing_height=0.0,
        max_swing_height=0.60,
    )


@dataclass(frozen=True, kw_only=True)
class GaitTiming(Configuration):
    """Durations of a walk's phases that the duration of a step does not define."""

    first_shift: NotNegative = 0.80
    """Weight shift before the first lift-off [s]."""
    transfer_share: ProperShare = 0.39
    """Share of a step's duration in double support [-]. The error of the DCM grows in
    single support; but the shorter the swing, the harder the almost straight trailing
    leg jerks the robot at lift-off."""
    settle: NotNegative = 0.70
    """Weight shift to the middle of the feet after the last step [s]."""
    rest: NotNegative = 0.50
    """Time at rest before STAND takes over [s]."""

    def transfer(self, duration: float) -> float:
        """Computes the double support before the lift-off of a step [s]."""
        return self.transfer_share * duration

    def swing(self, duration: float) -> float:
        """Computes the single support of a step of this duration [s]."""
        return (1.0 - self.transfer_share) * duration


@dataclass(frozen=True, kw_only=True)
class UsualSteps(Configuration):
    """Default steps of a walk, for demonstrations and planners."""

    stride: Positive = 0.20
    """Distance from one footprint to the next [m]."""
    turn: Positive = 0.15
    """Turn of each step on a bend or on the spot [rad]."""
    duration: Positive = 0.63
    """Duration of each step [s]."""
    swing_height: Positive = 0.10
    """Apex of each swing above the middle of its ends [m]."""


@dataclass(frozen=True, kw_only=True)
class PelvisRange(Configuration):
    """Range of pelvis poses for MANIPULATE.

    The limits of legs, motors and feet are computed for each pose; these ranges are the
    other limits. Each is a least and a greatest value.
    """

    height: Range = field(default_factory=lambda: [0.55, 0.95])
    """Height of the pelvis' origin above the mean of the soles [m]."""
    yaw: Range = field(default_factory=lambda: [-0.6, 0.6])
    """Yaw of the pelvis from the mean heading of the feet, to the left [rad]."""
    pitch: Range = field(default_factory=lambda: [-0.3, 0.5])
    """Pitch of the pelvis, forward and down [rad]."""
    roll: Range = field(default_factory=lambda: [-0.3, 0.3])
    """Roll of the pelvis, to the right [rad]."""
    com: Range = field(default_factory=lambda: [-0.5, 0.5])
    """Offset of the center of mass along either axis [m]; the support polygon limits it
    further."""

    def check(self) -> None:
        """Checks that no range is empty."""
        for name, (least, greatest) in vars(self).items():
            if least > greatest:
                wanted = "must be a least and a greatest value"
                raise _wrong(name, [least, greatest], wanted)


@dataclass(frozen=True, kw_only=True)
class RobotFile(Configuration):
    """The schema of a robot's YAML file."""

    urdf: Annotated[Name, "name the robot's URDF file, relative to this one"]
    """URDF file, relative to this one, or ``package://NAME/...``: in the package above
    this file, in one of ROS_PACKAGE_PATH, or in drake_models, which Drake fetches."""
    pelvis: Annotated[Name, "name the body at the top of both legs"]
    """Body at the top of both legs, free in the world."""
    chest: Annotated[Name, "name the body that balance keeps upright, or the pelvis"]
    """Body that balance keeps upright; the pelvis itself for a robot without a back."""
    hands: list[str] = field(default_factory=list)
    """Bodies of the left and the right hand; none for a robot without hands."""
    imu_frame: str = ""
    """Frame of the inertial sensor; the pelvis if left out."""
    feet: list[FootEntry]
    """Left foot, right foot: the order of foot_index."""
    sole: SoleSize
    """Contact rectangle of each sole."""
    contacts: list[ContactEntry] = field(default_factory=list)
    """Further surfaces that can carry load, such as hands."""
    pushed: list[str] = field(default_factory=list)
    """Bodies that teleoperation can push; pelvis, chest and hands if left out."""
    joints: list[JointEntry] = field(default_factory=list)
    """Every actuated joint in the order of the messages' arrays."""
    no_collisions: list[Annotated[list[str], Len(2, 2)]] = field(default_factory=list)
    """Pairs of bodies of the URDF whose shapes do not touch each other, such as
    ``[[hips, left_thigh]]``. Neighbors in the tree never do."""
    com_drop: NotNegative = 0.02
    """Lowering of the center of mass in standing and walking below the stand-prep pose
    [m]: bent knees give the trailing leg its reach."""
    stance_width: Positive = 0.24
    """Distance between the soles' middles of feet side by side [m]."""
    least_knee_flexion: NotNegative = 0.30
    """Least flexion of the knee, from the straight leg [rad]: a nearly straight leg
    loses control of the height."""
    most_knee_flexion: NotNegative = 1.9
    """Greatest flexion of the knee, from the straight leg, with the sole level [rad]:
    beyond it the ankle reaches its end stop and the leg lifts the body."""
    balance_effort: NotNegative = 15.0
    """Effort that a behavior must be able to apply at hip pitch and ankle pitch of a
    leg to balance with the leg [N·m]."""
    walk_limits: StepLimits = field(default_factory=StepLimits)
    """Limits of one step of WALK."""
    step_limits: StepLimits = field(default_factory=quasi_static_limits)
    """Limits of one step of STEP."""
    gait_timing: GaitTiming = field(default_factory=GaitTiming)
    """Durations of a walk's phases."""
    usual_steps: UsualSteps = field(default_factory=UsualSteps)
    """Default steps of a walk."""
    pelvis_range: PelvisRange = field(default_factory=PelvisRange)
    """Range of pelvis poses for MANIPULATE."""

    def check(self) -> None:
        """Checks what the fields' types do not express."""
        if len(self.hands) not in (0, 2):
            wanted = "must be the left and the right hand, or []"
            raise _wrong("hands", self.hands, wanted)
        if len(self.feet) != 2:
            wanted = "must be two: the left and the right foot"
            raise _wrong("feet", self.feet, wanted)
        _check_once("joints", [[one.name, one.alias] for one in self.joints])
        _check_once("contacts", [[one.name] for one in self.contacts])
        _check_order(self, ("least_knee_flexion", "most_knee_flexion"))
        usual, limits = self.usual_steps, self.walk_limits
        for name, value, most in (
            ("stride", usual.stride, limits.forward),
            ("turn", usual.turn, limits.toe_in),
            ("duration", usual.duration, limits.max_duration),
            ("swing_height", usual.swing_height, limits.max_swing_height),
        ):
            if value > most:
                wanted = f"must be at most {most:g}, which walk_limits allow"
                raise _wrong(f"usual_steps.{name}", value, wanted)
        if not limits.min_width <= self.stance_width <= limits.max_width:
            wanted = f"walk_limits allow {limits.min_width:g} to {limits.max_width:g}"
            raise _wrong("stance_width", self.stance_width, wanted)


def _wrong(name: str, value: object, problem: str) -> ScenarioError:
    return ScenarioError(name, value, f"is {shown(value)}; {problem}")


def _check_order(owner: object, names: Sequence[str]) -> None:
    """Checks that the values of fields do not decrease in order."""
    for low, high in itertools.pairwise(names):
        least, value = getattr(owner, low), getattr(owner, high)
        if value < least:
            raise _wrong(high, value, f"must be at least {low} ({least:g})")


def _check_once(path: str, entries: Iterable[Sequence[str]]) -> None:
    """Checks that no two entries share a name."""
    known: set[str] = set()
    for index, names in enumerate(entries):
        for name in filter(None, names):
            if name in known:
                wanted = "an earlier one has that name"
                raise _wrong(f"{path}[{index}].name", name, wanted)
            known.add(name)
