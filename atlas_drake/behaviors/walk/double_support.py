"""SHIFT and TRANSFER: both feet are down, until the DCM is ready for lift-off.

Computes each tick of these phases; ``planner`` makes the plans that they follow.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.walk.phase_control import WalkPhaseControl
from atlas_drake.behaviors.walk.phases import Transfer, WalkSettle, WalkShift, WalkState
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.behaviors.walk.rules import WalkRules
from atlas_drake.control.balance import feedback
from atlas_drake.frozen import replace
from atlas_drake.messages.event import Event


class DoubleSupport(WalkPhaseControl[WalkShift | Transfer]):
    """Shifts the weight and determines when a foot lifts off."""

    def __init__(self, balance: Balance, planner: WalkPlanner, rules: WalkRules):
        self._balance = balance
        self._planner = planner
        self._rules = rules
        legs = balance.robot.legs
        self._knees = [leg.knee for leg in legs]
        self._straight_knees = [leg.straight + rules.straight_flexion for leg in legs]

    def leave(self, phase: WalkShift | Transfer) -> WalkSettle:
        """Keeps both feet where they are."""
        return self._planner.settle(phase.progress, phase.planned.cop)

    def advance(
        self, phase: WalkShift | Transfer, observation: Observation
    ) -> tuple[WalkState, tuple[Event, ...]]:
        """Lifts off when the DCM is ready; settles if no step can be taken."""
        planner = self._planner
        if phase.elapsed < phase.duration:
            return phase, ()
        if not planner.coming(phase.progress):
            return planner.settle(phase.progress, phase.planned.cop), ()
        late = phase.elapsed - phase.duration
        patient = late < self._rules.longest_wait and not self._is_stretched(
            phase, observation
        )
        if patient and not self._is_dcm_ready(phase, observation):
            # Hold the plan at the moment of lift-off until the DCM is near it.
            return replace(phase, plan_time=phase.plan_time - observation.dt), ()
        # Measure the feet again: since touchdown the load has turned the soles flat.
        feet = (observation.foot_pose(0), observation.foot_pose(1))
        phase = replace(phase, progress=replace(phase.progress, feet=feet))
        phase, news = planner.warn(phase, observation.time)
        if not planner.coming(phase.progress):
            # The step cannot be taken from the present poses of the feet.
            return planner.settle(phase.progress, phase.planned.cop), news
        # Shorten the swing by the delay of lift-off, at most by one tick.
        return planner.swing(phase.progress, min(late, observation.dt)), news

    def command_feet(
        self, phase: WalkShift | Transfer, observation: Observation
    ) -> tuple[WalkShift | Transfer, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted, and unloads the foot that lifts off next."""
        loads = [math.inf, math.inf]
        if phase.unloading is not None and not phase.waiting:
            left_share = 1.0 - phase.elapsed / phase.duration
            unload = min(max(left_share / self._rules.unload_share, 0.01), 1.0)
            loads[phase.unloading] = unload
        left = self._balance.planted(observation, 0, loads[0])
        right = self._balance.planted(observation, 1, loads[1])
        return phase, (left, right)

    def _is_dcm_ready(
        self, phase: WalkShift | Transfer, observation: Observation
    ) -> bool:
        """Returns True if the DCM is near enough to its plan for single support."""
        dcm = feedback.dcm(observation.terms, phase.plan.omega)
        return float(np.hypot(*(dcm - phase.planned.dcm))) < self._rules.dcm_ready

    def _is_stretched(
        self, phase: WalkShift | Transfer, observation: Observation
    ) -> bool:
        """Returns True if the leg that lifts off next is at its full length.

        The straight leg of a planted foot holds the pelvis back, so that waiting does
        not bring the DCM nearer.
        """
        foot = phase.unloading
        return foot is not None and (
            float(observation.terms.q[self._knees[foot]]) < self._straight_knees[foot]
        )
