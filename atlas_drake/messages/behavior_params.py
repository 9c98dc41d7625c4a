"""What a behavior is asked to do: steps, a pelvis pose.

What a behavior reports back is in ``behavior_feedback``.
"""

from dataclasses import dataclass, field
from enum import IntEnum

from atlas_drake.messages.base import Message
from atlas_drake.messages.geometry import Pose, Vector3

NUM_REQUIRED_WALK_STEPS = 4
"""Steps that WALK looks ahead; the length of a step queue."""

NO_STEP = -1
"""The ``step_index`` of an entry that asks for no step."""


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepData(Message):
    """One step: which foot goes where, and how.

    Attributes:
        step_index: Number of the step, counted from 1; -1 means no step. 0 is where
            the foot stood when the behavior began, and only reported.
        foot_index: 0 left, 1 right.
        duration: Of the whole step, from one touchdown to the next [s]; 0.63 s is
            customary.
        pose: Where the foot shall land, in the world frame. The z axis of its
            orientation is the ground's normal.
        swing_height: Apex of the foot's path [m], from the midpoint between the feet.
    """

    step_index: int = NO_STEP
    foot_index: int = 0
    duration: float = 0.0
    pose: Pose = field(default_factory=Pose)
    swing_height: float = 0.0


def empty_step_queue() -> list[AtlasBehaviorStepData]:
    """Return a queue of distinct entries that ask for no step."""
    return [AtlasBehaviorStepData() for _ in range(NUM_REQUIRED_WALK_STEPS)]


@dataclass(slots=True, eq=False)
class AtlasBehaviorWalkParams(Message):
    """What WALK shall do.

    Attributes:
        step_queue: The next four steps. Indices increase and feet alternate; entries
            at the end may be empty.
        use_demo_walk: Ignore the queue and walk a path of the behavior's own.
        use_relative_step_height: A step's z is relative to the stance foot instead of
            to the world.
    """

    step_queue: list[AtlasBehaviorStepData] = field(default_factory=empty_step_queue)
    use_demo_walk: bool = False
    use_relative_step_height: bool = False


class ToeOff(IntEnum):
    """Values of ``AtlasBehaviorStepAction.toe_off``."""

    DISABLE = 0
    """Both soles stay flat."""
    ENABLE = 1
    """The heel of the foot left behind may rise where the leg would be too short."""
    FORCE_ENABLE = 2
    """It shall rise."""


def _upward() -> Vector3:
    return Vector3(0.0, 0.0, 1.0)


@dataclass(slots=True, eq=False)
class AtlasBehaviorFootData(Message):
    """Where a foot shall stand, in the world frame.

    Attributes:
        position: Of the sole's middle [m].
        yaw: Heading of the toes [rad].
        normal: Of the ground, of any length but zero.
    """

    position: Vector3 = field(default_factory=Vector3)
    yaw: float = 0.0
    normal: Vector3 = field(default_factory=_upward)


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepAction(Message):
    """How one step of STEP is taken.

    A value that its threshold rules out is ignored, and the behavior's own is used:
    that is what an empty message asks for, but for ``step_duration``.

    Attributes:
        step_duration: Of single support [s]; ignored from 0 down.
        sway_duration: Of the weight shift in double support before it [s]; ignored
            below 0.2 s.
        swing_height: How far the foot rises above the lift height while it moves [m];
            ignored below 0.1 m.
        lift_height: How far the foot is lifted straight up, above the higher of its two
            footholds, before it moves in x and y [m]; ignored below 0.1 m.
        toe_off: Whether the heel left behind may rise in the sway, as a ``ToeOff``. The
            feedback says DISABLE or ENABLE: whether it does.
        knee_nominal: Flexion of the standing knee in the step [rad]; ignored below
            0.3 rad.
        max_body_accel: Of the body in the sway [m/s²], which bounds its duration from
            below; 0 is ignored.
        max_foot_vel: Of the foot in the air [m/s], which bounds the step's duration
            from below; 0 is ignored.
        sway_end_dist: How far short of the standing foot the sway ends [m]; ignored
            unless it is within ±0.05 m.
        step_end_dist: How far the body leans into the step while the foot is lowered
            [m]; ignored unless it is within ±0.05 m.
    """

    TOE_OFF_DISABLE = ToeOff.DISABLE
    TOE_OFF_ENABLE = ToeOff.ENABLE
    TOE_OFF_FORCE_ENABLE = ToeOff.FORCE_ENABLE

    step_duration: float = 0.7
    sway_duration: float = 0.1
    swing_height: float = 0.0
    lift_height: float = 0.0
    toe_off: int = ToeOff.ENABLE
    knee_nominal: float = 0.0
    max_body_accel: float = 0.0
    max_foot_vel: float = 0.0
    sway_end_dist: float = 0.1
    step_end_dist: float = 0.1


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepSpec(Message):
    """One step of STEP in full.

    Attributes:
        step_index: Number of the step, counted from 1; -1 means no step.
        foot_index: 0 left, 1 right.
        foot: Where the foot shall stand.
        action: How it gets there.
    """

    step_index: int = NO_STEP
    foot_index: int = 0
    foot: AtlasBehaviorFootData = field(default_factory=AtlasBehaviorFootData)
    action: AtlasBehaviorStepAction = field(default_factory=AtlasBehaviorStepAction)


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepParams(Message):
    """What STEP shall do.

    Attributes:
        desired_step: The step to take. Its ``duration`` is that of single support.
        desired_step_spec: The step to take, with everything that can be said about it.
        use_spec: Read ``desired_step_spec`` instead of ``desired_step``.
        use_demo_walk: Ignore the desired step and take steps of the behavior's own.
        use_relative_step_height: The step's z is relative to the stance foot instead
            of to the world.
    """

    desired_step: AtlasBehaviorStepData = field(default_factory=AtlasBehaviorStepData)
    desired_step_spec: AtlasBehaviorStepSpec = field(
        default_factory=AtlasBehaviorStepSpec
    )
    use_spec: bool = False
    use_demo_walk: bool = False
    use_relative_step_height: bool = False


@dataclass(slots=True, eq=False)
class AtlasBehaviorStandParams(Message):
    """What STAND shall do: it takes no parameters."""


@dataclass(slots=True, eq=False)
class AtlasBehaviorPelvisServoParams(Message):
    """A pose of the pelvis relative to the feet.

    Attributes:
        pelvis_height: Of the pelvis' origin above the mean of the soles [m].
        pelvis_yaw: From the mean yaw of the feet, positive to the left [rad].
        pelvis_pitch: Positive leans forward [rad].
        pelvis_roll: Positive leans to the right [rad].
        com_v0: Center of mass from the middle of the soles along the line between
            them, positive to the left foot [m].
        com_v1: The same perpendicular to that line, positive forward when the feet
            are side by side [m].
    """

    pelvis_height: float = 0.8
    pelvis_yaw: float = 0.0
    pelvis_pitch: float = 0.0
    pelvis_roll: float = 0.0
    com_v0: float = 0.0
    com_v1: float = 0.0


@dataclass(slots=True, eq=False)
class AtlasBehaviorManipulateParams(Message):
    """What MANIPULATE shall do.

    Attributes:
        use_desired: Go to the desired pose; otherwise stay at the last one, or as the
            behavior began.
        desired: The pose. What of it is out of reach is clamped and reported.
        use_demo_mode: Ignore the desired pose and move the pelvis about.
    """

    use_desired: bool = False
    desired: AtlasBehaviorPelvisServoParams = field(
        default_factory=AtlasBehaviorPelvisServoParams
    )
    use_demo_mode: bool = False
