"""The common part of a walk's phases, their decisions, and what they read in a tick.

``transfer``, ``swing`` and ``settle`` have one phase each. A phase decides what follows
it; ``transitions`` makes the phase that follows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.phases import TIME_STEP, Phase, on_present_parts, sampled
from atlas_drake.behaviors.walk.config import GaitTiming, WalkConfig
from atlas_drake.behaviors.walk.gait import plan_walk
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmPlan, DcmReference, Pendulum
from atlas_drake.control.feet.swing_foot import FootSwing, SwingProfile
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages import WalkStatus
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import wrap_angle, yaw_of
from atlas_drake.support_polygon import SupportPolygon


class Decision(Enum):
    """What a phase decides in a tick."""

    STAY = "The phase goes on."
    WAIT = "The foot lifts off later: the DCM is not near its plan."
    LIFT_OFF = "The next foot lifts off."
    STEP_AGAIN = "The foot that has just landed swings again: a push, or a lost DCM."
    CATCH = "A foot steps though no step was commanded: a push, or a lost DCM."
    LAND = "The foot in the air has landed."
    STOP = "No step can be taken: the robot comes to rest over both feet."
    SHIFT_WEIGHT = "Steps have come: the weight shifts to the next stance foot."
    FINISH = "The robot is at rest: the walk is over."


@dataclass(frozen=True)
class WalkTick:
    """What the phases of a walk read in one tick.

    Attributes:
        observation: State of the robot.
        body: Reference of trunk and posture, of the last tick.
        leaving: True if the end of the walk is requested.
        balance: Support polygons, and commands of the feet.
        pendulum: The robot as the DCM plan sees it.
        config: Parameters of the walk.
    """

    observation: Observation
    body: BodyReference
    leaving: bool
    balance: Balance
    pendulum: Pendulum
    config: WalkConfig

    @property
    def dt(self) -> float:
        """Time since the last tick [s]."""
        return self.observation.dt

    @cached_property
    def dcm(self) -> np.ndarray:
        """Measured DCM, horizontal in W [m], shape (2,)."""
        return feedback.dcm(self.observation.terms, self.pendulum.omega)

    @cached_property
    def pelvis_turn(self) -> float:
        """Turn of the pelvis from its reference as a step for balance lands [rad]."""
        terms, body = self.observation.terms, self.body
        turned = wrap_angle(yaw_of(terms.R_WP) - body.yaw)
        rate = float(terms.V_WP[2]) - body.yaw_rate
        return turned + self.config.adjustment.turn_lead * rate

    @property
    def sole(self) -> tuple[float, float]:
        """Length and width of a sole [m]."""
        sole = self.balance.robot.file.sole
        return sole.length, sole.width

    @property
    def half_length(self) -> float:
        """Half the length of a sole [m]."""
        return self.sole[0] / 2

    def support(
        self, feet: tuple[FootPose, FootPose], on_toes: int | None = None
    ) -> SupportPolygon:
        """Computes the region of the CoP on both ``feet``, one of them on its toes."""
        if on_toes is None:
            return self.balance.support(*feet)
        return self.balance.support_on_toes(feet[1 - on_toes], feet[on_toes])

    def plan(
        self,
        progress: WalkProgress,
        cop: np.ndarray,
        duration: float,
        motion: FootSwing | None = None,
    ) -> DcmPlan:
        """Plans the DCM through the coming steps to rest.

        The plan begins with the present phase, of a ``duration`` [s] and a CoP that
        begins at ``cop`` in W [m], shape (2,), and with the ``motion`` of a foot in the
        air.
        """
        return plan_walk(
            cop,
            duration,
            progress.feet,
            progress.coming,
            motion,
            self.config,
            self.pendulum,
        )


@dataclass(frozen=True, kw_only=True)
class WalkPhase(Phase, ABC):
    """A phase of a walk: its data, its decision, and the commands of its feet."""

    progress: WalkProgress
    plan: DcmPlan
    duration: float  # Planned duration of the phase [s]
    plan_time: float = 0.0  # Time since the beginning of the plan [s]

    @abstractmethod
    def decide(self, tick: WalkTick) -> Decision:
        """Decides whether the phase goes on, and what follows it."""

    @abstractmethod
    def command_feet(
        self, tick: WalkTick
    ) -> tuple[Self, tuple[FootCommand, FootCommand]]:
        """Commands both feet, and advances their references by one tick."""

    # ---- ground --------------------------------------------------------------

    def on_what_carries(self, tick: WalkTick) -> Self:
        """Returns the phase on the parts of the soles that carry now.

        A landed sole counts as whole until it has had time to roll flat.
        """
        feet = on_present_parts(self.progress.feet, tick.observation)
        is_flat = self.elapsed >= tick.config.roll.flat_after
        if feet is self.progress.feet or not is_flat:
            return self
        progress = replace(self.progress, feet=feet)
        support = tick.support(feet, self.on_toes)
        return replace(self, progress=progress, support=support)

    @property
    def on_toes(self) -> int | None:
        """Foot that rises to its toes in the phase; None if both stay flat."""
        return None

    def airborne(self, tick: WalkTick) -> int | None:
        """Returns the foot that is in the air though the phase has it on the ground."""
        return tick.balance.airborne(tick.observation, self.progress.feet)

    # ---- DCM -----------------------------------------------------------------

    @cached_property
    def planned(self) -> DcmReference:
        """The present point of the plan."""
        return read_only(self.plan.evaluate(self.plan_time))

    def dcm_reference(self) -> DcmReference:
        """Evaluates the present references of DCM and CoP."""
        return self.planned

    def has_lost_dcm(self, tick: WalkTick) -> bool:
        """Returns True if no CoP under the feet brings the DCM back to its plan.

        The DCM is then farther outside the support polygon than its plan by more than
        ``rules.dcm_lost``.
        """
        margin = tick.config.rules.dcm_lost
        outside = self.support.distance_outside(tick.dcm)
        # In most ticks the DCM is inside, and the plan need not be evaluated.
        return outside > margin and (
            outside - self.support.distance_outside(self.planned.dcm) > margin
        )

    # ---- what the walk reports -----------------------------------------------

    @property
    def lower_pitch(self) -> float:
        """Pitch of the lower foot about its toes at the phase's end [rad]."""
        return 0.0

    def paths(self, com: np.ndarray, profile: SwingProfile) -> PlannedPaths:
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

    def time_to_touchdown(self, timing: GaitTiming) -> float:
        """Computes the time until the next foot touches down [s].

        The time is 0 without a coming step, and while touchdown is late.
        """
        coming, left = self.progress.coming, max(self.duration - self.elapsed, 0.0)
        if not coming:
            return 0.0
        in_air = self.progress.in_air is not None
        return left if in_air else left + timing.swing(coming[0].duration)

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of the phase."""
        return WalkStatus.SUBSTATE_STEPPING
