"""Feedback of the behaviors: transitions, progress, and saturated commands.

The parameters of the behaviors are in ``behavior_params``.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import (
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.behavior_params import (
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStepData,
    AtlasBehaviorStepSpec,
    empty_step_queue,
)

_WALK_SUBSTATES = (
    WalkStatus.SUBSTATE_SWAYING
    | WalkStatus.SUBSTATE_STEPPING
    | WalkStatus.SUBSTATE_CATCHING
)
_STEP_SUBSTATES = StepStatus.SUBSTATE_SWAYING | StepStatus.SUBSTATE_STEPPING


@dataclass(slots=True, eq=False)
class AtlasBehaviorFeedback(Message):
    """Result of the last transition.

    Attributes:
        status_flags: ``STATUS_...`` bits. They latch until the next transition.
        trans_from: The behavior that was left, as a ``Behavior``.
        trans_to: The behavior that was entered or refused, as a ``Behavior``.
    """

    STATUS_OK = BehaviorStatus.OK
    STATUS_TRANSITION_IN_PROGRESS = BehaviorStatus.TRANSITION_IN_PROGRESS
    STATUS_TRANSITION_SUCCESS = BehaviorStatus.TRANSITION_SUCCESS
    STATUS_FAILED_TRANS_UNKNOWN_BEHAVIOR = BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR
    STATUS_FAILED_TRANS_ILLEGAL_BEHAVIOR = BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR
    STATUS_FAILED_TRANS_COM_POS = BehaviorStatus.FAILED_TRANS_COM_POS
    STATUS_FAILED_TRANS_COM_VEL = BehaviorStatus.FAILED_TRANS_COM_VEL
    STATUS_FAILED_TRANS_VEL = BehaviorStatus.FAILED_TRANS_VEL
    STATUS_WARNING_AUTO_TRANS = BehaviorStatus.WARNING_AUTO_TRANS
    STATUS_ERROR_FALLING = BehaviorStatus.ERROR_FALLING

    status_flags: int = BehaviorStatus.OK
    trans_from: int = Behavior.NONE
    trans_to: int = Behavior.NONE


@dataclass(slots=True, eq=False)
class AtlasBehaviorStandFeedback(Message):
    """State of STAND.

    Attributes:
        status_flags: Always 0: STAND has no flags.
    """

    status_flags: int = 0


@dataclass(slots=True, eq=False)
class AtlasBehaviorWalkFeedback(Message):
    """State of WALK.

    Attributes:
        t_step_rem: Time until the swing foot touches down, or in double support until
            the next touchdown [s]; 0 if no step follows.
        current_step_index: Number of the step being taken; 0 before the first.
        next_step_index_needed: Index that WALK looks for at the next touchdown: the
            first one that it does not have, at most the present one plus four.
        status_flags: ``WALK_...`` bits; exactly one substate while WALK is active.
        step_queue_saturated: The steps after saturation, as they will be taken.
    """

    WALK_OKAY = WalkStatus.OKAY
    WALK_SUBSTATE_SWAYING = WalkStatus.SUBSTATE_SWAYING
    WALK_SUBSTATE_STEPPING = WalkStatus.SUBSTATE_STEPPING
    WALK_SUBSTATE_CATCHING = WalkStatus.SUBSTATE_CATCHING
    WALK_WARNING_INSUFFICIENT_STEP_DATA = WalkStatus.WARNING_INSUFFICIENT_STEP_DATA
    WALK_ERROR_INCONSISTENT_STEPS = WalkStatus.ERROR_INCONSISTENT_STEPS

    t_step_rem: float = 0.0
    current_step_index: int = 0
    next_step_index_needed: int = 1
    status_flags: int = WalkStatus.OKAY
    step_queue_saturated: list[AtlasBehaviorStepData] = field(
        default_factory=empty_step_queue
    )

    @property
    def is_active(self) -> bool:
        """True while WALK is active, or a behavior that is derived from it."""
        return bool(self.status_flags & _WALK_SUBSTATES)


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepFeedback(Message):
    """State of STEP.

    Attributes:
        t_step_rem: Planned time until the next step is needed [s]; 0 while the behavior
            waits for a step.
        current_step_index: Number of the present or last step; 0 before the first.
        next_step_index_needed: Index that the next desired step should have.
        status_flags: ``STEP_...`` bits; exactly one substate while STEP is active:
            SWAYING with both feet on the ground, STEPPING with one in the air.
        desired_step_saturated: The step after saturation, as it is taken.
        desired_step_spec_saturated: The step after saturation in full, with the action
            values in use.
    """

    STEP_OKAY = StepStatus.OKAY
    STEP_SUBSTATE_SWAYING = StepStatus.SUBSTATE_SWAYING
    STEP_SUBSTATE_STEPPING = StepStatus.SUBSTATE_STEPPING

    t_step_rem: float = 0.0
    current_step_index: int = 0
    next_step_index_needed: int = 1
    status_flags: int = StepStatus.OKAY
    desired_step_saturated: AtlasBehaviorStepData = field(
        default_factory=AtlasBehaviorStepData
    )
    desired_step_spec_saturated: AtlasBehaviorStepSpec = field(
        default_factory=AtlasBehaviorStepSpec
    )

    @property
    def is_active(self) -> bool:
        """True while STEP is active, or a behavior that is derived from it."""
        return bool(self.status_flags & _STEP_SUBSTATES)


@dataclass(slots=True, eq=False)
class AtlasBehaviorManipulateFeedback(Message):
    """State of MANIPULATE.

    Attributes:
        status_flags: Always 0: MANIPULATE has no flags.
        clamped: The desired pelvis pose, clamped to feasible values.
        internal_desired: The present reference on the way to ``clamped``.
        internal_sensed: The measured pose of the robot.
    """

    status_flags: int = 0
    clamped: AtlasBehaviorPelvisServoParams = field(
        default_factory=AtlasBehaviorPelvisServoParams
    )
    internal_desired: AtlasBehaviorPelvisServoParams = field(
        default_factory=AtlasBehaviorPelvisServoParams
    )
    internal_sensed: AtlasBehaviorPelvisServoParams = field(
        default_factory=AtlasBehaviorPelvisServoParams
    )
