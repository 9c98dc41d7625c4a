"""The state of a walk between ticks: its progress and its present phase.

Frozen data, and functions of these data alone. ``planner`` makes the phases;
``both_feet`` and ``single_support`` compute their ticks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from atlas_drake.behaviors.footsteps import next_runs
from atlas_drake.behaviors.phases import TIME_STEP, Phase, sampled
from atlas_drake.behaviors.walk.config import GaitTiming
from atlas_drake.control.balance.dcm_plan import DcmPlan, DcmReference
from atlas_drake.control.feet import swing_foot
from atlas_drake.control.feet.foot_roll import rising
from atlas_drake.control.feet.sole_motion import Pitch
from atlas_drake.frozen import replace
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS, WalkStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import FootPose, Footstep

LOOK_AHEAD = NUM_REQUIRED_WALK_STEPS
"""Number of steps in the plan."""


@dataclass(frozen=True)
class WalkProgress:
    """Feet and steps of a walk in any phase."""

    feet: tuple[FootPose, FootPose]  # Poses of the soles, the last ones on the ground
    aimed: tuple[FootPose, FootPose]  # Landing poses aimed at; at first, ``feet``
    pending: tuple[Footstep, ...]  # Steps not begun, by index
    next_index: int  # Index of the next step to begin
    request: BehaviorRequest  # The last request whose steps were read
    last_foot: int | None = None  # Foot of the step begun last; None before the first
    last_index: int = 0  # Index of the step begun last; 0 before the first step
    warned: frozenset[tuple[int, str]] = frozenset()  # Step and topic of each warning
    recovery_index: int = 0  # Index of the last recovery or square-up step; 0 at first

    @property
    def last_was_recovery(self) -> bool:
        """True if the step begun last was not commanded."""
        return 0 < self.last_index == self.recovery_index

    @property
    def known(self) -> tuple[Footstep, ...]:
        """The next steps without a gap in their indices, as many as are planned."""
        return next_runs(self.pending, self.next_index, LOOK_AHEAD)


@dataclass(frozen=True, kw_only=True)
class WalkPhase(Phase):
    """Common part of all phases of a walk."""

    progress: WalkProgress
    plan: DcmPlan  # Plan of the DCM
    duration: float  # Planned duration of the phase [s]
    plan_time: float = 0.0  # Time since the beginning of the plan [s]

    @property
    def in_air(self) -> Footstep | None:
        """The step whose foot is in the air; None while both feet are down."""
        return None

    @property
    def lower_pitch(self) -> float:
        """Pitch of the lower foot about its toes at the phase's end [rad]."""
        return 0.0

    @property
    def planned(self) -> DcmReference:
        """The present point of the plan."""
        return self.plan.evaluate(self.plan_time)

    def dcm_reference(self) -> DcmReference:
        """Evaluates the present references of DCM and CoP."""
        return self.planned

    def paths(self, com: np.ndarray, profile: swing_foot.SwingProfile) -> PlannedPaths:
        """Integrates ċ = ω (ξ - c), exactly for a constant DCM between two points."""
        times = np.arange(self.plan_time, self.plan.duration, TIME_STEP)
        if times.size < 2:
            return PlannedPaths()
        dcm, cop = sampled(self.plan.evaluate, times)
        decay = np.exp(-self.plan.omega * TIME_STEP)
        path = [np.asarray(com, dtype=float)]
        for before, after in pairwise(dcm):
            goal = 0.5 * (before + after)
            path.append(goal + decay * (path[-1] - goal))
        return PlannedPaths(com=np.array(path), dcm=dcm, cop=cop)

    def time_to_touchdown(
        self, coming: Sequence[Footstep], timing: GaitTiming
    ) -> float:
        """Computes the time until the next foot touches down [s].

        The time is 0 without a coming step, and while touchdown is late.
        """
        if not coming:
            return 0.0
        left = max(self.duration - self.elapsed, 0.0)
        if self.in_air is not None:
            return left
        return left + timing.swing(coming[0].duration)

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of the phase."""
        return WalkStatus.SUBSTATE_STEPPING


@dataclass(frozen=True, kw_only=True)
class BothFeet(WalkPhase):
    """Common part of ``InitialTransfer`` and ``Transfer``, which end with lift-off."""

    brought_forward: bool = False  # Lift-off was brought forward to save the balance

    @property
    def waiting(self) -> bool:
        """True while lift-off is later than planned, because the DCM is not ready."""
        return self.elapsed > self.duration

    def dcm_reference(self) -> DcmReference:
        """Evaluates the plan; while lift-off waits, the CoP reference is the DCM's."""
        planned = self.planned
        return replace(planned, cop=planned.dcm) if self.waiting else planned


@dataclass(frozen=True, kw_only=True)
class InitialTransfer(BothFeet):
    """The weight shifts over the first stance foot."""

    unloading: int | None  # Foot that lifts off; None if no step was known

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of a weight shift."""
        return WalkStatus.SUBSTATE_SWAYING


@dataclass(frozen=True, kw_only=True)
class Transfer(BothFeet):
    """Double support between two steps: the weight moves to the foot that landed."""

    unloading: int  # Foot that lifts off at the end
    toe_off: float = 0.0  # Pitch of that foot about its toes at lift-off [rad]
    toe_off_time: float = 0.0  # Time in which it grows [s]
    landed: float = 0.0  # Pitch with which the other foot landed [rad]

    @property
    def lower_pitch(self) -> float:
        """Pitch that the leaving foot has at lift-off [rad]."""
        return self.toe_off

    def leaving_pitch(self, time: float) -> Pitch:
        """Evaluates the pitch of the leaving foot, if it has one, at a ``time`` [s]."""
        return rising(self.toe_off, self.toe_off_time, time)


@dataclass(frozen=True, kw_only=True)
class WalkSwing(WalkPhase):
    """Single support: one foot is in the air."""

    step: Footstep  # Step being taken; balance may move its landing place
    sent: Footstep  # The same step as commanded
    motion: swing_foot.FootSwing  # Reference of the swing foot
    sensitivity: float  # ∂(DCM planned for touchdown)/∂(landing place) [-]
    stops: bool  # Whether its plan comes to rest, as no step was known after it

    @property
    def in_air(self) -> Footstep:
        """The step being taken."""
        return self.step

    def lowers(self, profile: swing_foot.SwingProfile) -> bool:
        """Returns True once the foot may sink to a landing that is further down."""
        return self.motion.progress >= 1.0 - profile.climb_share

    @property
    def lower_pitch(self) -> float:
        """Pitch with which a foot lands on its toes [rad]."""
        return max(self.motion.landing_pitch, 0.0)

    def paths(self, com: np.ndarray, profile: swing_foot.SwingProfile) -> PlannedPaths:
        """Adds the path of the swing sole from lift-off to touchdown."""
        swing = swing_foot.begin_swing(
            self.motion.start, self.motion.duration, around=self.motion.around
        )
        points = [swing.start.p_WF]
        while swing.remaining > 0.0:
            step = min(TIME_STEP, max(swing.remaining, 1e-6))
            swing, reference = swing_foot.advance_swing(swing, self.step, profile, step)
            points.append(reference.p_WF)
        return replace(super().paths(com, profile), swing=np.array(points))


@dataclass(frozen=True, kw_only=True)
class FinalTransfer(WalkPhase):
    """The robot comes to rest over both feet."""

    obstacle: str  # Why the walk ends before a commanded step; empty if all are taken

    def time_to_touchdown(
        self, coming: Sequence[Footstep], timing: GaitTiming
    ) -> float:
        """Returns 0: no foot lifts off."""
        return 0.0

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of settling with the reason for the walk's end."""
        if self.obstacle:
            why = WalkStatus.ERROR_INCONSISTENT_STEPS
        elif leaving:
            why = WalkStatus.OKAY
        else:
            why = WalkStatus.WARNING_INSUFFICIENT_STEP_DATA
        return WalkStatus.SUBSTATE_CATCHING | why


WalkState = InitialTransfer | WalkSwing | Transfer | FinalTransfer
"""The state of a walk: one of its phases."""
