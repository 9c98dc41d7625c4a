"""The state of STEP between ticks: one dataclass for each of its phases.

Frozen data, and functions of these data alone. ``both_feet`` and
``single_support`` compute the ticks of each phase.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from atlas_drake.behaviors.phases import TIME_STEP, Phase, sampled
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.control.feet.sole_motion import Pitch
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.parts.step.step_swing import StepSwing as SwingPath
from atlas_drake.parts.step.weight_shift import WeightShift

Next = TypeVar("Next", bound="StepPhase")


@dataclass(frozen=True)
class StepProgress:
    """Progress of STEP in any phase."""

    index: int = 0  # Index of the present or last step; 0 before the first step
    leaving: bool = False  # True if STAND was requested with a foot in the air
    request: BehaviorRequest | None = None  # Last request read; None before the first
    done: BehaviorRequest | None = None  # Last request whose step has begun, or cannot


@dataclass(frozen=True, kw_only=True)
class StepPhase(Phase):
    """Common part of all phases of STEP.

    ``support`` is the region of the CoP with both soles flat, or on the stance foot;
    ``elapsed`` counts from lift-off in single support.
    """

    progress: StepProgress
    feet: tuple[FootPose, FootPose]  # Poses of the soles, the last ones on the ground
    hips: np.ndarray  # Hip positions from the center of mass in W [m], shape (2, 3)
    shift: WeightShift  # Motion of the center of mass
    shift_time: float = 0.0  # Time since the beginning of that motion [s]
    lean: float = 0.0  # Pitch of the trunk [rad]

    @property
    def carrying(self) -> tuple[FootPose, ...]:
        """Poses of the feet that are on the ground."""
        return self.feet

    @property
    def in_air(self) -> Footstep | None:
        """The step whose foot is in the air; None while both feet are down."""
        return None

    @property
    def reported(self) -> Footstep | None:
        """The present or last step, if any."""
        return None

    def become(self, kind: type[Next], **changes: Any) -> Next:
        """Returns the phase that follows, with the fields that both have."""
        shared = {
            name: value
            for name, value in vars(self).items()
            if name in kind.__dataclass_fields__
        }
        return kind(**{**shared, "elapsed": 0.0, **changes})

    def dcm_reference(self, omega: float) -> DcmReference:
        """Evaluates the present references of DCM and CoP."""
        return self.shift.evaluate(self.shift_time, omega)

    def paths(self, omega: float) -> PlannedPaths:
        """Returns the paths of the weight shift; in single support, of the foot."""
        shift = self.shift
        times = np.arange(self.shift_time, shift.duration, TIME_STEP)
        if times.size < 2:
            return PlannedPaths()
        dcm, cop = sampled(lambda time: shift.evaluate(time, omega), times)
        com = np.array([shift.motion(time)[0] for time in times])
        return PlannedPaths(com=com, dcm=dcm, cop=cop)

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry load on the planned ground [s]."""
        return 0.0


@dataclass(frozen=True, kw_only=True)
class Rest(StepPhase):
    """Both feet are down; the weight shifts to between them and stays there."""

    last: Footstep | None = None  # The last step; None before the first step
    touchdown_foot: int | None = None  # Foot that just landed, if any
    gave_up: bool = False  # True if the last weight shift was abandoned

    @property
    def reported(self) -> Footstep | None:
        """The last step, if any."""
        return self.last


@dataclass(frozen=True, kw_only=True)
class Stepping(StepPhase):
    """Common part of the phases of a step, from ``StepShift`` to ``StepSettle``."""

    sent: Footstep  # The step as requested
    step: Footstep  # The same step as executed
    swing: SwingPath  # Path of the swing foot

    @property
    def stance(self) -> int:
        """The foot that stays on the ground."""
        return 1 - self.step.foot

    @property
    def reported(self) -> Footstep:
        """The step being taken."""
        return self.step


@dataclass(frozen=True, kw_only=True)
class StepShift(Stepping):
    """Both feet are down; the weight shifts over the stance foot."""

    heel: float  # Angle by which the leaving foot's heel has risen at lift-off [rad]
    touchdown_foot: int | None  # Foot that just landed, if any

    def heel_motion(self, begins_share: float) -> Pitch:
        """Evaluates the pitch of the leaving foot about its toes."""
        if self.heel == 0.0:
            return Pitch()
        begins = begins_share * self.shift.duration
        takes = self.shift.duration - begins
        share = min(max((self.elapsed - begins) / takes, 0.0), 1.0)
        s, ds, dds = quintic_progress(share)
        return Pitch(self.heel * s, self.heel * ds / takes, self.heel * dds / takes**2)

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        left = max(self.shift.duration - self.elapsed, 0.0)
        return left + self.swing.duration + settle


@dataclass(frozen=True, kw_only=True)
class InAir(Stepping):
    """Common part of the phases with a foot in the air: ``StepSwing`` and ``Lower``."""

    went_back: bool = False  # The foot found no ground and returns to where it was

    @property
    def carrying(self) -> tuple[FootPose, ...]:
        """Pose of the stance foot."""
        return (self.feet[self.stance],)

    @property
    def in_air(self) -> Footstep:
        """The step being taken."""
        return self.step

    def paths(self, omega: float) -> PlannedPaths:
        """Returns the path of the swing foot."""
        swing = self.swing
        count = max(int(swing.duration / TIME_STEP), 2)
        times = np.linspace(0.0, swing.duration, count)
        return PlannedPaths(swing=np.array([swing.evaluate(t).p_WF for t in times]))

    def foothold(self) -> FootPose:
        """Computes the landing pose, lower if the foot has found no ground yet."""
        goal = self.step.pose
        z = float(self.swing.evaluate(self.elapsed).p_WF[2])
        if z >= goal.p_WF[2]:
            return goal
        return FootPose(np.array([goal.p_WF[0], goal.p_WF[1], z]), goal.R_WF)

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        return max(self.swing.duration - self.elapsed, 0.0) + settle


@dataclass(frozen=True, kw_only=True)
class StepSwing(InAir):
    """One foot is in the air and moves up and across."""


@dataclass(frozen=True, kw_only=True)
class Lower(InAir):
    """One foot is in the air and comes down."""


@dataclass(frozen=True, kw_only=True)
class StepSettle(Stepping):
    """Both feet are down; the new foot is pressed flat."""

    went_back: bool  # True if the foot returned to its lift-off pose

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        return max(settle - self.elapsed, 0.0)


StepState = Rest | StepShift | StepSwing | Lower | StepSettle
"""The state of STEP: one of its phases."""
