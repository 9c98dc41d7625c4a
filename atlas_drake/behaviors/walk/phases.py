"""The state of a walk between ticks: its course, and the phase that it is in.

Frozen data, and what follows from these data alone. ``planner`` makes the phases; what
happens in each of them is in ``double_support``, ``single_support`` and ``settling``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from atlas_drake.behaviors.step.queue import next_runs
from atlas_drake.control.balance.dcm_plan import DcmPlan, DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet import swing_foot
from atlas_drake.control.feet.footstep import FootPose, Footstep
from atlas_drake.frozen import replace
from atlas_drake.messages import WalkStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.robot import GaitTiming


@dataclass(frozen=True)
class Course:
    """Feet and steps of a walk, whatever its phase.

    Attributes:
        feet: Poses in which the soles are, or last were, on the ground.
        aimed: Poses in which the soles were to land; at first, where they were.
        pending: Steps not begun, by index.
        next_index: Index of the next step to begin.
        request: The last one whose steps were read.
        last_foot: Foot of the step begun last; None before the first step.
        last_index: Index of the step begun last; 0 before the first step.
        told: Warnings given before: indices of steps, and what of them.
    """

    feet: tuple[FootPose, FootPose]
    aimed: tuple[FootPose, FootPose]
    pending: tuple[Footstep, ...]
    next_index: int
    request: BehaviorRequest
    last_foot: int | None = None
    last_index: int = 0
    told: frozenset[tuple[int, str]] = frozenset()

    @property
    def known(self) -> tuple[Footstep, ...]:
        """Steps to come that follow each other without a gap."""
        return next_runs(self.pending, self.next_index)


@dataclass(frozen=True, kw_only=True)
class WalkPhase:
    """What all phases of a walk have.

    Attributes:
        course: Feet and steps.
        plan: Of the DCM.
        support: Where the CoP may lie.
        duration: Planned duration of the phase [s].
        elapsed: Time in the phase [s].
        plan_time: Time into the plan [s].
    """

    course: Course
    plan: DcmPlan
    support: SupportPolygon
    duration: float
    elapsed: float = 0.0
    plan_time: float = 0.0

    @property
    def in_air(self) -> Footstep | None:
        """The step whose foot is in the air; None while both feet are down."""
        return None

    @property
    def planned(self) -> DcmReference:
        """The point of the plan that the phase has come to."""
        return self.plan.evaluate(self.plan_time)

    def dcm_reference(self) -> DcmReference:
        """Evaluates where DCM and CoP shall be now."""
        return self.planned

    def time_to_touchdown(
        self, coming: Sequence[Footstep], timing: GaitTiming
    ) -> float:
        """Computes the time until the next foot touches down [s].

        0 when no step is to come, and where a foot is late.

        Args:
            coming: Steps that the walk will take, one in the air first.
            timing: Of the phases.
        """
        return 0.0

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of the phase.

        Args:
            leaving: Whether the walk was asked to end.
        """
        return WalkStatus.SUBSTATE_STEPPING


@dataclass(frozen=True, kw_only=True)
class BothFeet(WalkPhase):
    """What the phases that end with lift-off have: ``Shift`` and ``Transfer``."""

    @property
    def waiting(self) -> bool:
        """Whether both feet are down longer than planned, until the DCM is ready."""
        return self.elapsed > self.duration

    def dcm_reference(self) -> DcmReference:
        """Evaluates the plan; where lift-off waits, the DCM rests over the CoP."""
        planned = self.planned
        return replace(planned, cop=planned.dcm) if self.waiting else planned

    def time_to_touchdown(
        self, coming: Sequence[Footstep], timing: GaitTiming
    ) -> float:
        """Computes the time until the first of ``coming`` touches down [s]."""
        if not coming:
            return 0.0
        left = max(self.duration - self.elapsed, 0.0)
        return left + timing.swing(coming[0].duration)


@dataclass(frozen=True, kw_only=True)
class Shift(BothFeet):
    """The weight shifts over the first stance foot.

    Attributes:
        unloading: Foot that lifts off at the end; None if no step was known at the
            beginning.
    """

    unloading: int | None

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of a weight shift."""
        return WalkStatus.SUBSTATE_SWAYING


@dataclass(frozen=True, kw_only=True)
class Transfer(BothFeet):
    """Double support between two steps: the weight moves to the foot that landed.

    Attributes:
        unloading: Foot that lifts off at the end.
    """

    unloading: int


@dataclass(frozen=True, kw_only=True)
class Swing(WalkPhase):
    """Single support: one foot is in the air.

    Attributes:
        step: Step being taken; balance may move its landing place.
        sent: The same step as it was sent.
        motion: Reference of the swing foot.
        sensitivity: How the DCM planned for touchdown moves with the next foot [-].
    """

    step: Footstep
    sent: Footstep
    motion: swing_foot.Swing
    sensitivity: float

    @property
    def in_air(self) -> Footstep:
        """The step being taken."""
        return self.step

    def time_to_touchdown(
        self, coming: Sequence[Footstep], timing: GaitTiming
    ) -> float:
        """Computes the time until the foot in the air touches down [s]."""
        return max(self.duration - self.elapsed, 0.0)


@dataclass(frozen=True, kw_only=True)
class Settle(WalkPhase):
    """The robot comes to rest over both feet.

    Attributes:
        obstacle: Why the walk ends before a step that was sent; empty if all are taken.
    """

    obstacle: str

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of settling, which say why the walk ends."""
        if self.obstacle:
            why = WalkStatus.ERROR_INCONSISTENT_STEPS
        elif leaving:
            why = WalkStatus.OKAY
        else:
            why = WalkStatus.WARNING_INSUFFICIENT_STEP_DATA
        return WalkStatus.SUBSTATE_CATCHING | why


Phase = Shift | Swing | Transfer | Settle
"""The state of a walk: one of its phases."""
