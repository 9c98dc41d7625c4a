"""The schema of a robot's YAML file.

The schema, its defaults, which are Atlas' values, and the checks of the file alone.
Consistency of file and URDF is checked in ``fit``.
"""

# Annotations must be types, not strings: docs/make_reference.py reads them.
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

from atlas_drake.bounds import Positive, ProperShare, Signed
from atlas_drake.errors import RobotDescriptionError, shown

LEGS = ("l_leg", "r_leg")
"""Limbs in the order of foot indices."""
LIMBS = ("back", "neck", *LEGS, "l_arm", "r_arm")


@dataclass
class JointEntry:
    """One actuated joint, in message order."""

    name: str = ""
    """Name in the URDF."""
    alias: str = ""
    """Second name of the joint for users; for Atlas' joints the name in its first
    version."""
    limb: str = ""
    """Limb of the joint: back, neck, l_leg, r_leg, l_arm or r_arm."""
    kp: float = 0.0
    """Default position gain in force before any command [N·m/rad]."""
    kd: float = 0.0
    """Default derivative gain in force before any command [N·m·s/rad]."""
    stand_prep: Signed = 0.0
    """Position in the stand-prep pose, from which STAND can begin [rad]."""


@dataclass
class FootEntry:
    """One foot: its body and the frame in which footsteps are commanded."""

    body: str = ""
    """Name in the URDF."""
    sole_frame: str = ""
    """Frame at the center of the sole on its bottom plane, x ahead, z along the
    normal."""


@dataclass
class SoleSize:
    """Contact rectangle of each sole."""

    length: float = 0.0
    """Size along the sole's x [m]."""
    width: float = 0.0
    """Size along the sole's y [m]."""


@dataclass
class ContactEntry:
    """A surface of the robot, beside the soles, that can carry load."""

    name: str = ""
    """Name of the contact for tasks and behaviors."""
    frame: str = ""
    """Frame or body F of the URDF that the surface belongs to."""
    p_FC: list[Signed] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Center of the surface in F [m]."""
    rpy_FC: list[Signed] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Roll, pitch and yaw of the contact frame C in F [rad]; z of C points from the
    touched object into the robot, as a sole's does."""
    length: float = 0.0
    """Size of the contact rectangle along x of C [m]."""
    width: float = 0.0
    """Size of the contact rectangle along y of C [m]."""


@dataclass
class StepLimits:
    """Limits of one step relative to the stance foot.

    Lateral distances and turns are positive away from the stance foot: a left foot
        turns its toes to the left.
    """

    forward: float = 0.42
    """Longest step ahead [m]."""
    backward: float = 0.32
    """Longest step back [m]."""
    min_width: float = 0.18
    """Least lateral distance between the feet, center to center [m]."""
    max_width: float = 0.50
    """Greatest lateral distance between the feet, center to center [m]."""
    rise: float = 0.10
    """Largest step up or down [m]."""
    meant_rise: float = 0.40
    """Heights farther than this from the stance foot are treated as not given [m]: on
    level ground a step may have the height of the pelvis."""
    tilt: float = 0.30
    """Steepest slope of the ground at a foothold [rad]."""
    toe_out: float = 0.5
    """Largest turn outward [rad]."""
    toe_in: float = 0.25
    """Largest turn inward [rad]."""
    min_duration: Positive = 0.60
    """Shortest duration of a step [s]."""
    max_duration: float = 3.0
    """Longest duration of a step from and to a place near the other foot [s]."""
    near: float = 0.40
    """Distance of the feet up to which a step may take the longest duration [m]."""
    far: float = 0.60
    """Distance of the feet from which a step takes ``far_duration`` at most [m]."""
    far_duration: float = 1.0
    """Longest duration of a step with the feet far apart [s]: in a slower step the
    center of mass would have to be over the stance foot while the other leg cannot
    reach."""
    min_swing_height: float = 0.03
    """Lowest apex of a swing above the middle of its ends [m]."""
    max_swing_height: float = 0.30
    """Highest apex of a swing above the middle of its ends [m]."""


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


@dataclass
class GaitTiming:
    """Durations of a walk's phases that the duration of a step does not define."""

    first_shift: float = 0.80
    """Weight shift before the first lift-off [s]."""
    transfer_share: ProperShare = 0.39
    """Share of a step's duration in double support [-]. The error of the DCM grows in
    single support; but the shorter the swing, the harder the almost straight trailing
    leg jerks the robot at lift-off."""
    settle: float = 0.70
    """Weight shift to the middle of the feet after the last step [s]."""
    rest: float = 0.50
    """Time at rest before STAND takes over [s]."""

    def transfer(self, duration: float) -> float:
        """Computes the double support before the lift-off of a step [s]."""
        return self.transfer_share * duration

    def swing(self, duration: float) -> float:
        """Computes the single support of a step of this duration [s]."""
        return (1.0 - self.transfer_share) * duration


@dataclass
class UsualSteps:
    """Default steps of a walk, for demonstrations and planners."""

    stride: Positive = 0.20
    """Distance from one footprint to the next [m]."""
    turn: Positive = 0.15
    """Turn of each step on a bend or on the spot [rad]."""
    duration: Positive = 0.63
    """Duration of each step [s]."""
    swing_height: Positive = 0.10
    """Apex of each swing above the middle of its ends [m]."""


@dataclass
class PelvisRange:
    """Range of pelvis poses for MANIPULATE.

    The limits of legs, motors and feet are computed for each pose; these ranges are the
    other limits. Each is a least and a greatest value.
    """

    height: list[Signed] = field(default_factory=lambda: [0.55, 0.95])
    """Height of the pelvis' origin above the mean of the soles [m]."""
    yaw: list[Signed] = field(default_factory=lambda: [-0.6, 0.6])
    """Yaw of the pelvis from the mean heading of the feet, to the left [rad]."""
    pitch: list[Signed] = field(default_factory=lambda: [-0.3, 0.5])
    """Pitch of the pelvis, forward and down [rad]."""
    roll: list[Signed] = field(default_factory=lambda: [-0.3, 0.3])
    """Roll of the pelvis, to the right [rad]."""
    com: list[Signed] = field(default_factory=lambda: [-0.5, 0.5])
    """Offset of the center of mass along either axis [m]; the support polygon limits it
    further."""


@dataclass
class RobotFile:
    """The schema of a robot's YAML file."""

    urdf: str = ""
    """URDF file, relative to this one, or ``package://NAME/...``: in the package above
    this file, in one of ROS_PACKAGE_PATH, or in drake_models, which Drake fetches."""
    pelvis: str = ""
    """Body at the top of both legs, free in the world."""
    chest: str = ""
    """Body that balance keeps upright; the pelvis itself for a robot without a back."""
    hands: list[str] = field(default_factory=list)
    """Bodies of the left and the right hand; none for a robot without hands."""
    imu_frame: str = ""
    """Frame of the inertial sensor; the pelvis if left out."""
    feet: list[FootEntry] = field(default_factory=list)
    """Left foot, right foot: the order of foot_index."""
    sole: SoleSize = field(default_factory=SoleSize)
    """Contact rectangle of each sole."""
    contacts: list[ContactEntry] = field(default_factory=list)
    """Further surfaces that can carry load, such as hands."""
    pushed: list[str] = field(default_factory=list)
    """Bodies that teleoperation can push; pelvis, chest and hands if left out."""
    joints: list[JointEntry] = field(default_factory=list)
    """Every actuated joint in the order of the messages' arrays."""
    no_collisions: list[list[str]] = field(default_factory=list)
    """Pairs of bodies of the URDF whose shapes do not touch each other, such as
    ``[[hips, left_thigh]]``. Neighbors in the tree never do."""
    com_drop: float = 0.02
    """Lowering of the center of mass in standing and walking below the stand-prep pose
    [m]: bent knees give the trailing leg its reach."""
    stance_width: Positive = 0.24
    """Distance between the soles' middles of feet side by side [m]."""
    least_knee_flexion: float = 0.30
    """Least flexion of the knee, from the straight leg [rad]: a nearly straight leg
    loses control of the height."""
    most_knee_flexion: float = 1.9
    """Greatest flexion of the knee, from the straight leg, with the sole level [rad]:
    beyond it the ankle reaches its end stop and the leg lifts the body."""
    balance_effort: float = 15.0
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


def check_file(file: RobotFile) -> None:
    """Checks the file alone; types and bounds of its values are already checked.

    Raises:
        RobotDescriptionError: Naming the first field that cannot be used.
    """
    for name in ("urdf", "pelvis", "chest"):
        if not getattr(file, name):
            raise _wrong(name, "", f"is missing; {_MEANING[name]}")
    if len(file.hands) not in (0, 2):
        raise _wrong("hands", file.hands, "must be the left and the right hand, or []")
    if len(file.feet) != 2:
        raise _wrong("feet", file.feet, "must be two: the left and the right foot")
    for index, foot in enumerate(file.feet):
        for name, value in vars(foot).items():
            if not value:
                raise _wrong(f"feet[{index}].{name}", value, "is missing")
    for name, value in vars(file.sole).items():
        _check_given(f"sole.{name}", value)
    _check_joints(file.joints)
    _check_contacts(file.contacts)
    for index, pair in enumerate(file.no_collisions):
        if len(pair) != 2:
            raise _wrong(f"no_collisions[{index}]", pair, "must be two bodies")
    _check_order("", file, ("least_knee_flexion", "most_knee_flexion"))
    for name in ("walk_limits", "step_limits"):
        _check_limits(name, getattr(file, name))
    _check_usual(file)
    for name, bounds in vars(file.pelvis_range).items():
        where = f"pelvis_range.{name}"
        if len(bounds) != 2 or bounds[0] > bounds[1]:
            raise _wrong(where, bounds, "must be a least and a greatest value")


_MEANING = {
    "urdf": "name the robot's URDF file, relative to this one",
    "pelvis": "name the body at the top of both legs",
    "chest": "name the body that balance keeps upright, or the pelvis",
}


def _wrong(name: str, value: object, problem: str) -> RobotDescriptionError:
    if value != "":
        problem = f"is {shown(value)}; {problem}"
    return RobotDescriptionError(name, value, problem)


def _check_given(name: str, value: float) -> None:
    """Checks a length that has no default."""
    if not value > 0.0:
        raise _wrong(name, value, "must be more than 0")


def _check_order(path: str, owner: object, names: Sequence[str]) -> None:
    """Checks that the values of fields do not decrease in order."""
    for low, high in itertools.pairwise(names):
        least = getattr(owner, low)
        if getattr(owner, high) < least:
            value = getattr(owner, high)
            raise _wrong(path + high, value, f"must be at least {low} ({least:g})")


def _check_joints(joints: Sequence[JointEntry]) -> None:
    known: set[str] = set()
    for index, joint in enumerate(joints):
        where = f"joints[{index}]"
        if not joint.name:
            raise _wrong(f"{where}.name", "", "is missing; give the URDF's name")
        for name in (joint.name, joint.alias):
            if name and name in known:
                raise _wrong(f"{where}.name", name, "an earlier joint has that name")
            known.add(name)
        if joint.limb not in LIMBS:
            wanted = f"must be one of {', '.join(LIMBS)} (joint {joint.name})"
            raise _wrong(f"{where}.limb", joint.limb or None, wanted)


def _check_contacts(contacts: Sequence[ContactEntry]) -> None:
    for index, contact in enumerate(contacts):
        where = f"contacts[{index}]"
        for name in ("name", "frame"):
            if not getattr(contact, name):
                raise _wrong(f"{where}.{name}", "", "is missing")
        if any(contact.name == other.name for other in contacts[:index]):
            raise _wrong(f"{where}.name", contact.name, "an earlier one has that name")
        for name in ("p_FC", "rpy_FC"):
            vector = getattr(contact, name)
            if len(vector) != 3:
                raise _wrong(f"{where}.{name}", vector, "must be three numbers")
        for name in ("length", "width"):
            _check_given(f"{where}.{name}", getattr(contact, name))


def _check_limits(path: str, limits: StepLimits) -> None:
    for pair in (
        ("min_width", "max_width"),
        ("min_duration", "far_duration", "max_duration"),
        ("near", "far"),
        ("min_swing_height", "max_swing_height"),
    ):
        _check_order(f"{path}.", limits, pair)
    if limits.near == limits.far:
        raise _wrong(f"{path}.far", limits.far, "must be more than near")


def _check_usual(file: RobotFile) -> None:
    usual, limits = file.usual_steps, file.walk_limits
    for name, value, most in (
        ("stride", usual.stride, limits.forward),
        ("turn", usual.turn, limits.toe_in),
        ("duration", usual.duration, limits.max_duration),
        ("swing_height", usual.swing_height, limits.max_swing_height),
    ):
        if value > most:
            wanted = f"must be at most {most:g}, which walk_limits allow"
            raise _wrong(f"usual_steps.{name}", value, wanted)
    if not limits.min_width <= file.stance_width <= limits.max_width:
        wanted = f"walk_limits allow {limits.min_width:g} to {limits.max_width:g}"
        raise _wrong("stance_width", file.stance_width, wanted)
