"""What the robot reports: joints and sensors, behaviors, and the IMU alone."""

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
from atlas_drake.messages.geometry import Header, Pose, Quaternion, Vector3, Wrench


class JointIndices:
    """Joint indices of the 28-joint Atlas by their v3 names; v1 names as aliases."""

    __slots__ = ()

    back_bkz = 0
    back_bky = 1
    back_bkx = 2
    neck_ry = 3
    l_leg_hpz = 4
    l_leg_hpx = 5
    l_leg_hpy = 6
    l_leg_kny = 7
    l_leg_aky = 8
    l_leg_akx = 9
    r_leg_hpz = 10
    r_leg_hpx = 11
    r_leg_hpy = 12
    r_leg_kny = 13
    r_leg_aky = 14
    r_leg_akx = 15
    l_arm_shy = 16
    l_arm_shx = 17
    l_arm_ely = 18
    l_arm_elx = 19
    l_arm_wry = 20
    l_arm_wrx = 21
    r_arm_shy = 22
    r_arm_shx = 23
    r_arm_ely = 24
    r_arm_elx = 25
    r_arm_wry = 26
    r_arm_wrx = 27

    # The names of the first version. Knees, outer shoulders and elbows kept theirs.
    back_lbz = back_bkz
    back_mby = back_bky
    back_ubx = back_bkx
    neck_ay = neck_ry
    l_leg_uhz = l_leg_hpz
    l_leg_mhx = l_leg_hpx
    l_leg_lhy = l_leg_hpy
    l_leg_uay = l_leg_aky
    l_leg_lax = l_leg_akx
    r_leg_uhz = r_leg_hpz
    r_leg_mhx = r_leg_hpx
    r_leg_lhy = r_leg_hpy
    r_leg_uay = r_leg_aky
    r_leg_lax = r_leg_akx
    l_arm_usy = l_arm_shy
    l_arm_uwy = l_arm_wry
    l_arm_mwx = l_arm_wrx
    r_arm_usy = r_arm_shy
    r_arm_uwy = r_arm_wry
    r_arm_mwx = r_arm_wrx


@dataclass(slots=True, eq=False)
class Imu(Message):
    """One measurement of the IMU.

    Attributes:
        header: Time of the measurement.
        orientation: Orientation of the unit in the world frame.
        angular_velocity: Angular velocity in the unit's frame [rad/s].
        linear_acceleration: Specific force in the unit's frame [m/s²]: standing
            still, it points up and measures gravity.
    """

    header: Header = field(default_factory=Header)
    orientation: Quaternion = field(default_factory=Quaternion)
    angular_velocity: Vector3 = field(default_factory=Vector3)
    linear_acceleration: Vector3 = field(default_factory=Vector3)


@dataclass(slots=True, eq=False)
class AtlasState(JointIndices, Message):
    """Measured joint states, gains in force, motion of the pelvis and contact wrenches.

    Every array has one element per joint in message order. ``AtlasState.neck_ry`` and
    similar constants are joint indices of the 28-joint Atlas; the indices of any robot
    are in ``robot.joints``.

    Attributes:
        header: Time of the measurement.
        position: Joint positions [rad].
        velocity: Joint velocities [rad/s].
        effort: Joint efforts [N·m].
        kp_position, ki_position, kd_position, kp_velocity: Gains in force, see
            ``AtlasCommand``.
        i_effort_min, i_effort_max: Bounds of the integral term in force [N·m].
        k_effort: Shares of user control in force, 0 to 255.
        orientation: Orientation of the pelvis in the world frame.
        angular_velocity: Angular velocity of the pelvis, in the pelvis frame [rad/s].
        linear_acceleration: Specific force at the IMU, in the IMU's frame [m/s²].
        l_foot, r_foot: Contact wrench on the foot, in the world frame about the center
            of the sole, one control tick old.
        l_hand, r_hand: Contact wrench on the hand, in the world frame about the origin
            of its link, one control tick old.
    """

    header: Header = field(default_factory=Header)
    position: Numbers = field(default_factory=list)
    velocity: Numbers = field(default_factory=list)
    effort: Numbers = field(default_factory=list)
    kp_position: Numbers = field(default_factory=list)
    ki_position: Numbers = field(default_factory=list)
    kd_position: Numbers = field(default_factory=list)
    kp_velocity: Numbers = field(default_factory=list)
    i_effort_min: Numbers = field(default_factory=list)
    i_effort_max: Numbers = field(default_factory=list)
    k_effort: Shares = field(default_factory=list)
    orientation: Quaternion = field(default_factory=Quaternion)
    angular_velocity: Vector3 = field(default_factory=Vector3)
    linear_acceleration: Vector3 = field(default_factory=Vector3)
    l_foot: Wrench = field(default_factory=Wrench)
    r_foot: Wrench = field(default_factory=Wrench)
    l_hand: Wrench = field(default_factory=Wrench)
    r_hand: Wrench = field(default_factory=Wrench)


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
