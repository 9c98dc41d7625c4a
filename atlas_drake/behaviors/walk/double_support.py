"""SHIFT and TRANSFER: both feet are down, until the DCM is ready for lift-off.

What these phases do in a tick; the plans that they follow are made in ``planner``.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FULL_LOAD, Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.walk.phase_control import PhaseControl
from atlas_drake.behaviors.walk.phases import Phase, Settle, Shift, Transfer
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.behaviors.walk.rules import WalkRules
from atlas_drake.control.balance import feedback
from atlas_drake.frozen import replace
from atlas_drake.messages.event import Event


class DoubleSupport(PhaseControl[Shift | Transfer]):
    """Shifts the weight and decides when a foot lifts off."""

    def __init__(self, balance: Balance, planner: WalkPlanner, rules: WalkRules):
        self._balance = balance
        self._planner = planner
        self._rules = rules
        legs = balance.robot.legs
        self._knees = [leg.knee for leg in legs]
        self._straight_knees = [leg.straight + rules.straight_flexion for leg in legs]

    def leave(self, phase: Shift | Transfer) -> Settle:
        """Keeps both feet where they are."""
        return self._planner.settle(phase.course, phase.planned.cop)

    def advance(
        self, phase: Shift | Transfer, observation: Observation
    ) -> tuple[Phase, tuple[Event, ...]]:
        """Lifts off when the DCM is ready; settles if no step can be taken."""
        planner = self._planner
        if phase.elapsed < phase.duration:
            return phase, ()
        if not planner.coming(phase.course):
            return planner.settle(phase.course, phase.planned.cop), ()
        late = phase.elapsed - phase.duration
        patient = late < self._rules.longest_wait and not self._is_stretched(
            phase, observation
        )
        if patient and not self._is_dcm_ready(phase, observation):
            # Hold the plan at the moment of lift-off until the DCM is there.
            return replace(phase, plan_time=phase.plan_time - observation.dt), ()
        # Since touchdown the soles have come to lie flat under their load.
        feet = (observation.foot_pose(0), observation.foot_pose(1))
        phase = replace(phase, course=replace(phase.course, feet=feet))
        phase, news = planner.warn(phase, observation.time)
        if not planner.coming(phase.course):
            # From where the feet are now, the step cannot be taken.
            return planner.settle(phase.course, phase.planned.cop), news
        # A tick that the phase was too long is taken off the swing.
        return planner.swing(phase.course, min(max(late, 0.0), observation.dt)), news

    def command_feet(
        self, phase: Shift | Transfer, observation: Observation
    ) -> tuple[Shift | Transfer, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted, and unloads the one that is to lift off."""
        loads = [FULL_LOAD, FULL_LOAD]
        if phase.unloading is not None and not phase.waiting:
            left_share = 1.0 - phase.elapsed / phase.duration
            unload = min(max(left_share / self._rules.unload_share, 0.01), 1.0)
            loads[phase.unloading] = unload
        left = self._balance.planted(observation, 0, loads[0])
        right = self._balance.planted(observation, 1, loads[1])
        return phase, (left, right)

    def _is_dcm_ready(self, phase: Shift | Transfer, observation: Observation) -> bool:
        """Returns whether the DCM is near enough to its plan for single support."""
        dcm = feedback.dcm(observation.terms, phase.plan.omega)
        return float(np.hypot(*(dcm - phase.planned.dcm))) < self._rules.dcm_ready

    def _is_stretched(self, phase: Shift | Transfer, observation: Observation) -> bool:
        """Returns whether the leg that is to lift off is at its full length.

        Planted, it holds the pelvis back, so that no waiting brings the DCM nearer.
        """
        foot = phase.unloading
        return foot is not None and (
            float(observation.terms.q[self._knees[foot]]) < self._straight_knees[foot]
        )
