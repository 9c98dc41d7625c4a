"""The robot's report on its behaviors.

Joints and sensors are reported in ``atlas_state``.
"""

from dataclasses import dataclass, field
from typing import Any

from atlas_drake.errors import ErrorCode
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_feedback import (
    AtlasBehaviorFeedback,
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
)
from atlas_drake.messages.fields import Numbers, Shares
from atlas_drake.messages.geometry import Header, Pose, Vector3


@dataclass(slots=True, eq=False)
class AtlasPositionData(Message):
    """Position and velocity of the pelvis in the world frame.

    Attributes:
        position: Position of the pelvis [m].
        velocity: Velocity of the pelvis [m/s].
    """

    position: Vector3 = field(default_factory=Vector3)
    velocity: Vector3 = field(default_factory=Vector3)


def _two_poses() -> list[Pose]:
    return [Pose(), Pose()]


@dataclass(slots=True, eq=False)
class AtlasSimInterfaceState(Message):
    """The active behavior, its progress, and the joint efforts that it requests.

    Attributes:
        header: Time of the report.
        error_code: Error of the last command, as an ``ErrorCode``.
        current_behavior: The active behavior, as a ``Behavior``.
        desired_behavior: The behavior requested last; it differs from the current one
            during a transition.
        f_out: Efforts that the behavior requests [N·m], one per joint in message order,
            before the blend with the user's efforts.
        pos_est: Estimated motion of the pelvis in the world frame.
        foot_pos_est: Estimated poses of the left and the right foot, in this order,
            in the world frame.
        behavior_feedback: Result of the last transition.
        stand_feedback: State of STAND.
        step_feedback: State of STEP.
        walk_feedback: State of WALK.
        manipulate_feedback: State of MANIPULATE.
        k_effort: Shares of user control in force, one per joint in message order.
        feedback: Feedback of a user's own behavior; None without one.
    """

    NO_ERRORS = ErrorCode.NO_ERRORS
    ERROR_UNSPECIFIED = ErrorCode.UNSPECIFIED
    ERROR_VALUE_OUT_OF_RANGE = ErrorCode.VALUE_OUT_OF_RANGE
    ERROR_INVALID_INDEX = ErrorCode.INVALID_INDEX
    ERROR_FAILED_TO_START_BEHAVIOR = ErrorCode.FAILED_TO_START_BEHAVIOR
    ERROR_NO_ACTIVE_BEHAVIOR = ErrorCode.NO_ACTIVE_BEHAVIOR
    ERROR_NO_SUCH_BEHAVIOR = ErrorCode.NO_SUCH_BEHAVIOR
    ERROR_BEHAVIOR_NOT_IMPLEMENTED = ErrorCode.BEHAVIOR_NOT_IMPLEMENTED
    ERROR_TIME_RAN_BACKWARD = ErrorCode.TIME_RAN_BACKWARD

    NONE = Behavior.NONE
    FREEZE = Behavior.FREEZE
    STAND_PREP = Behavior.STAND_PREP
    STAND = Behavior.STAND
    WALK = Behavior.WALK
    STEP = Behavior.STEP
    MANIPULATE = Behavior.MANIPULATE
    USER = Behavior.USER

    header: Header = field(default_factory=Header)
    error_code: int = ErrorCode.NO_ERRORS
    current_behavior: int = Behavior.NONE
    desired_behavior: int = Behavior.NONE
    f_out: Numbers = field(default_factory=list)
    pos_est: AtlasPositionData = field(default_factory=AtlasPositionData)
    foot_pos_est: list[Pose] = field(default_factory=_two_poses)
    behavior_feedback: AtlasBehaviorFeedback = field(
        default_factory=AtlasBehaviorFeedback
    )
    stand_feedback: AtlasBehaviorStandFeedback = field(
        default_factory=AtlasBehaviorStandFeedback
    )
    step_feedback: AtlasBehaviorStepFeedback = field(
        default_factory=AtlasBehaviorStepFeedback
    )
    walk_feedback: AtlasBehaviorWalkFeedback = field(
        default_factory=AtlasBehaviorWalkFeedback
    )
    manipulate_feedback: AtlasBehaviorManipulateFeedback = field(
        default_factory=AtlasBehaviorManipulateFeedback
    )
    k_effort: Shares = field(default_factory=list)
    feedback: Any = None
