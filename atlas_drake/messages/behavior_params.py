"""Parameters of the behaviors: steps, a pelvis pose.

The feedback of the behaviors is in ``behavior_feedback``.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any

from annotated_types import Interval
from pydantic import AfterValidator, WrapValidator

from atlas_drake.config import is_whole
from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import ToeOff
from atlas_drake.messages.fields import (
    MAX_INDEX,
    Flag,
    Index,
    NotNegative,
    Number,
    Positive,
    not_zero,
    several,
)
from atlas_drake.messages.geometry import Pose, Vector3

NUM_REQUIRED_WALK_STEPS = 4
"""Number of steps that WALK previews; the length of a step queue."""

NO_STEP = -1
"""The ``step_index`` of an entry that requests no step."""
HOME_STEP = 0
"""The ``step_index`` of the pose in which a foot stands as WALK begins."""

StepIndex = Annotated[Index, Interval(ge=1, le=MAX_INDEX)]
"""Number of a step, or NO_STEP."""
FootIndex = Annotated[Index, Interval(ge=0, le=1)]
"""0 left, 1 right."""


def unless_empty(kind: type[Message], *others: int) -> WrapValidator:
    """Returns the annotation of a step of which nothing is read if it is NO_STEP.

    ``others`` are further indices that request no step.
    """
    empty = kind().freeze()

    def read(step: Any, check: Any) -> Any:
        index = step.step_index if isinstance(step, kind) else None  # type: ignore[attr-defined]
        requests_none = is_whole(index) and index in (NO_STEP, *others)
        return empty if requests_none else check(step)

    return WrapValidator(read)


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepData(Message):
    """One step: foot, landing pose, duration and swing height.

    Attributes:
        step_index: Number of the step, counted from 1; -1 means no step. 0 is the pose
            in which the foot stands as WALK begins, which a queue may begin with.
        foot_index: 0 left, 1 right.
        duration: Duration of the whole step, from one touchdown to the next [s]; 0.63 s
            is customary.
        pose: Landing pose of the foot in the world frame. The z axis of its orientation
            is the ground's normal.
        swing_height: Apex of the foot's path [m], from the midpoint between the feet.
    """

    step_index: StepIndex = NO_STEP
    foot_index: FootIndex = 0
    duration: Positive = 0.0
    pose: Pose = field(default_factory=Pose)
    swing_height: NotNegative = 0.0


OptionalStep = Annotated[AtlasBehaviorStepData, unless_empty(AtlasBehaviorStepData)]
QueueEntry = Annotated[
    AtlasBehaviorStepData, unless_empty(AtlasBehaviorStepData, HOME_STEP)
]


def _in_order(
    queue: tuple[AtlasBehaviorStepData, ...],
) -> tuple[AtlasBehaviorStepData, ...]:
    """Check length and indices of a step queue; a repeated step becomes empty."""
    if len(queue) != NUM_REQUIRED_WALK_STEPS:
        raise ValueError(
            f"must have {NUM_REQUIRED_WALK_STEPS} entries, has {len(queue)}; an empty "
            "AtlasBehaviorStepData() is no step"
        )
    last, steps = 0, list(queue)
    for place, step in enumerate(queue):
        if step.step_index == NO_STEP:
            continue
        if step in queue[:place]:
            steps[place] = AtlasBehaviorStepData().freeze()
        elif step.step_index <= last:
            raise InvalidMessageError(
                f"[{place}].step_index",
                step.step_index,
                f"must increase from entry to entry, {step.step_index} follows {last}",
                ErrorCode.INVALID_INDEX,
            )
        last = step.step_index
    return tuple(steps)


StepQueue = Annotated[
    list[AtlasBehaviorStepData], several(QueueEntry), AfterValidator(_in_order)
]
"""The steps that WALK previews, empty ones included."""


def empty_step_queue() -> list[AtlasBehaviorStepData]:
    """Return a queue of distinct entries that request no step."""
    return [AtlasBehaviorStepData() for _ in range(NUM_REQUIRED_WALK_STEPS)]


@dataclass(slots=True, eq=False)
class AtlasBehaviorWalkParams(Message):
    """Parameters of WALK.

    Attributes:
        step_queue: The next four steps. Indices increase and feet alternate. Entries
            may be empty, have index 0 or repeat a step before them: they request
            nothing.
        use_demo_walk: Ignore the queue and walk a predefined path.
        use_relative_step_height: A step's z is relative to the stance foot instead of
            to the world.
    """

    step_queue: StepQueue = field(default_factory=empty_step_queue)
    use_demo_walk: Flag = False
    use_relative_step_height: Flag = False


Normal = Annotated[Vector3, not_zero("xyz")]
"""A vector that has a direction."""


def _upward() -> Vector3:
    return Vector3(0.0, 0.0, 1.0)


@dataclass(slots=True, eq=False)
class AtlasBehaviorFootData(Message):
    """Landing pose of a foot in the world frame.

    Attributes:
        position: Position of the center of the sole [m].
        yaw: Heading of the toes [rad].
        normal: Normal of the ground, of any length but zero.
    """

    position: Vector3 = field(default_factory=Vector3)
    yaw: Number = 0.0
    normal: Normal = field(default_factory=_upward)


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepAction(Message):
    """Timing and motion of one step of STEP.

    A value beyond its threshold is ignored, and the behavior's default is used. An
    empty message so requests the defaults, except for ``step_duration``.

    Attributes:
        step_duration: Duration of single support [s]; ignored if 0 or negative.
        sway_duration: Duration of the weight shift in double support before the step
            [s]; ignored below 0.2 s.
        swing_height: Rise of the foot above the lift height while it moves [m]; ignored
            below 0.1 m.
        lift_height: Height of the straight lift above the higher of the foot's two
            footholds, before the foot moves in x and y [m]; ignored below 0.1 m.
        toe_off: Use of toe-off in the weight shift, as a ``ToeOff``. In the feedback
            ENABLE means that the heel rises, DISABLE that it does not.
        knee_nominal: Flexion of the standing knee in the step [rad]; ignored below
            0.3 rad.
        max_body_accel: Greatest acceleration of the body in the weight shift [m/s²],
            which bounds its duration from below; 0 is ignored.
        max_foot_vel: Greatest speed of the swing foot [m/s], which bounds the step's
            duration from below; 0 is ignored.
        sway_end_dist: Distance from the stance foot at which the weight shift ends [m];
            ignored unless within ±0.05 m.
        step_end_dist: Shift of the body toward the landing foot while the foot is
            lowered [m]; ignored unless within ±0.05 m.
    """

    TOE_OFF_DISABLE = ToeOff.DISABLE
    TOE_OFF_ENABLE = ToeOff.ENABLE
    TOE_OFF_FORCE_ENABLE = ToeOff.FORCE_ENABLE

    step_duration: Number = 0.7
    sway_duration: Number = 0.1
    swing_height: Number = 0.0
    lift_height: Number = 0.0
    toe_off: Annotated[Index, Interval(ge=0, le=2)] = ToeOff.ENABLE
    knee_nominal: Number = 0.0
    max_body_accel: NotNegative = 0.0
    max_foot_vel: NotNegative = 0.0
    sway_end_dist: Number = 0.1
    step_end_dist: Number = 0.1


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepSpec(Message):
    """One step of STEP in full.

    Attributes:
        step_index: Number of the step, counted from 1; -1 means no step.
        foot_index: 0 left, 1 right.
        foot: Landing pose of the foot.
        action: Timing and motion of the step.
    """

    step_index: StepIndex = NO_STEP
    foot_index: FootIndex = 0
    foot: AtlasBehaviorFootData = field(default_factory=AtlasBehaviorFootData)
    action: AtlasBehaviorStepAction = field(default_factory=AtlasBehaviorStepAction)


OptionalStepSpec = Annotated[AtlasBehaviorStepSpec, unless_empty(AtlasBehaviorStepSpec)]


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepParams(Message):
    """Parameters of STEP.

    Attributes:
        desired_step: The step to take. Its ``duration`` is the duration of single
            support.
        desired_step_spec: The step to take, with all its action values.
        use_spec: Read ``desired_step_spec`` instead of ``desired_step``.
        use_demo_walk: Ignore the desired step and take predefined steps.
        use_relative_step_height: The step's z is relative to the stance foot instead
            of to the world.
    """

    desired_step: OptionalStep = field(default_factory=AtlasBehaviorStepData)
    desired_step_spec: OptionalStepSpec = field(default_factory=AtlasBehaviorStepSpec)
    use_spec: Flag = False
    use_demo_walk: Flag = False
    use_relative_step_height: Flag = False


@dataclass(slots=True, eq=False)
class AtlasBehaviorStandParams(Message):
    """Parameters of STAND, which has none."""


@dataclass(slots=True, eq=False)
class AtlasBehaviorPelvisServoParams(Message):
    """A pose of the pelvis relative to the feet.

    Attributes:
        pelvis_height: Height of the pelvis' origin above the mean of the soles [m].
        pelvis_yaw: Yaw from the mean yaw of the feet, positive to the left [rad].
        pelvis_pitch: Pitch, positive forward [rad].
        pelvis_roll: Roll, positive to the right [rad].
        com_v0: Center of mass from the middle of the soles along the line between
            them, positive to the left foot [m].
        com_v1: Center of mass perpendicular to that line, positive forward when the
            feet are side by side [m].
    """

    pelvis_height: Number = 0.8
    pelvis_yaw: Number = 0.0
    pelvis_pitch: Number = 0.0
    pelvis_roll: Number = 0.0
    com_v0: Number = 0.0
    com_v1: Number = 0.0


@dataclass(slots=True, eq=False)
class AtlasBehaviorManipulateParams(Message):
    """Parameters of MANIPULATE.

    Attributes:
        use_desired: Go to the desired pose; otherwise keep the last desired pose, or
            the pose at the start of the behavior.
        desired: The desired pose. Values out of reach are clamped and reported.
        use_demo_mode: Ignore the desired pose and move the pelvis through a
            demonstration.
    """

    use_desired: Flag = False
    desired: AtlasBehaviorPelvisServoParams = field(
        default_factory=AtlasBehaviorPelvisServoParams
    )
    use_demo_mode: Flag = False
