"""What the behaviors report: transitions, progress, and what they made of a wish.

What they are asked to do is in ``behavior_params``.
"""

from dataclasses import dataclass, field
from enum import IntFlag

from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_params import (
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStepData,
    AtlasBehaviorStepSpec,
    empty_step_queue,
)


class BehaviorStatus(IntFlag):
    """Bits of ``AtlasBehaviorFeedback.status_flags``."""

    OK = 0
    """Nothing to report."""
    TRANSITION_IN_PROGRESS = 1
    """The behavior that is left comes to an end in good order first."""
    TRANSITION_SUCCESS = 2
    """The behavior asked for is active."""
    FAILED_TRANS_UNKNOWN_BEHAVIOR = 4
    """There is no such behavior."""
    FAILED_TRANS_ILLEGAL_BEHAVIOR = 8
    """It may not follow the active one."""
    FAILED_TRANS_COM_POS = 16
    """The center of mass is not over the feet, or the robot falls or lies."""
    FAILED_TRANS_COM_VEL = 32
    """The center of mass moves too fast."""
    FAILED_TRANS_VEL = 64
    """A joint moves too fast."""
    WARNING_AUTO_TRANS = 128
    """The behavior ended by itself, and STAND followed."""
    ERROR_FALLING = 256
    """The robot falls or lies on the ground; its motors only damp its joints."""


class WalkStatus(IntFlag):
    """Bits of ``AtlasBehaviorWalkFeedback.status_flags``."""

    OKAY = 0
    """Nothing to report."""
    SUBSTATE_SWAYING = 1
    """The weight moves over the first stance foot."""
    SUBSTATE_STEPPING = 2
    """Steps are taken."""
    SUBSTATE_CATCHING = 4
    """The last step is taken, and the robot comes to rest."""
    WARNING_INSUFFICIENT_STEP_DATA = 8
    """There was no next step in time: the walk ends."""
    ERROR_INCONSISTENT_STEPS = 16
    """The next step cannot follow: it is for the same foot again, leads too far up or
    down, or to another level out of reach. The walk ends."""


class StepStatus(IntFlag):
    """Bits of ``AtlasBehaviorStepFeedback.status_flags``."""

    OKAY = 0
    """Nothing to report."""
    SUBSTATE_SWAYING = 1
    """The weight moves over the foot that stays, or back."""
    SUBSTATE_STEPPING = 2
    """A foot is in the air."""


@dataclass(slots=True, eq=False)
class AtlasBehaviorFeedback(Message):
    """How the last change of behavior went.

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
    """How STAND goes.

    Attributes:
        status_flags: 0, as STAND has no flags of its own.
    """

    status_flags: int = 0


@dataclass(slots=True, eq=False)
class AtlasBehaviorWalkFeedback(Message):
    """How WALK goes.

    Attributes:
        t_step_rem: Time until the foot in the air touches down, or else the next one
            [s]; 0 when none is to come.
        current_step_index: Number of the step being taken; 0 before the first.
        next_step_index_needed: First index that the next step queue should hold.
        status_flags: ``WALK_...`` bits; exactly one substate while WALK is active.
        step_queue_saturated: The steps as they will really be taken.
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


@dataclass(slots=True, eq=False)
class AtlasBehaviorStepFeedback(Message):
    """How STEP goes.

    Attributes:
        t_step_rem: Time until the next step is needed, as planned [s]; 0 while the
            behavior waits for it.
        current_step_index: Number of the step being taken or taken last; 0 before the
            first.
        next_step_index_needed: Index that the next desired step should have.
        status_flags: ``STEP_...`` bits; exactly one substate while STEP is active:
            SWAYING with both feet on the ground, STEPPING with one in the air.
        desired_step_saturated: The step as it is really taken.
        desired_step_spec_saturated: Likewise, with everything that it is taken with.
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


@dataclass(slots=True, eq=False)
class AtlasBehaviorManipulateFeedback(Message):
    """How MANIPULATE goes.

    Attributes:
        status_flags: It has no flags of its own: 0.
        clamped: The pelvis pose that is really pursued.
        internal_desired: The reference at this moment, on its way there.
        internal_sensed: The pose that the robot is in.
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
