"""What a behavior is asked to do: steps, a pelvis pose.

What a behavior reports back is in ``behavior_feedback``.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.geometry import Pose

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


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepParams(Message):
    """What STEP shall do.

    Attributes:
        desired_step: The step to take.
        use_demo_walk: Ignore the desired step and take steps of the behavior's own.
        use_relative_step_height: The step's z is relative to the stance foot instead
            of to the world.
    """

    desired_step: AtlasBehaviorStepData = field(default_factory=AtlasBehaviorStepData)
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
