"""REST and SETTLE: both feet are down, and the next step may begin.

Computes each tick of these phases; the weight shift of a step is in ``shift``.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footstep_event import footstep_event
from atlas_drake.behaviors.step.action import DesiredStep
from atlas_drake.behaviors.step.beginning import StepBeginning
from atlas_drake.behaviors.step.phase_control import StepPhaseControl
from atlas_drake.behaviors.step.phases import Rest, StepSettle, StepState
from atlas_drake.behaviors.step.step_balance import Reach, StepBalance
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.messages.event import Event


class RestControl(StepPhaseControl[Rest]):
    """Stands over the middle of the feet until a step is requested."""

    def __init__(self, balance: StepBalance, beginning: StepBeginning):
        super().__init__(balance)
        self._beginning = beginning

    def advance(
        self, phase: Rest, observation: Observation, wanted: DesiredStep | None
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Begins the requested step; after an abandoned step, only at rest."""
        if phase.gave_up and phase.elapsed < phase.shift.duration:
            return phase, ()
        return self._beginning.begin(phase, observation, wanted)

    def reach(self, phase: Rest) -> Reach:
        """Returns both feet, with the body half-way between them."""
        return self._balance.reach_at_rest(phase.feet)

    def command_feet(
        self, phase: Rest, observation: Observation, cop: np.ndarray
    ) -> tuple[FootCommand, FootCommand]:
        """Keeps both feet planted; a foot that just landed is pressed flat."""
        balance = self._balance
        if phase.fresh is not None and balance.is_fresh(phase):
            return balance.pressed(phase, observation, phase.fresh, cop)
        return balance.planted(observation, 0)


class SettleControl(StepPhaseControl[StepSettle]):
    """Presses the new foot flat before the weight moves."""

    def __init__(self, balance: StepBalance, beginning: StepBeginning):
        super().__init__(balance)
        self._beginning = beginning

    def advance(
        self, phase: StepSettle, observation: Observation, wanted: DesiredStep | None
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Ends the step, and begins the next step if one is requested."""
        if phase.elapsed < self._balance.rules.settle:
            return phase, ()
        taken = phase.taken
        landed = observation.foot_pose(taken.foot)
        rest = self._beginning.rest(
            phase, observation, with_foot(phase.feet, taken.foot, landed)
        )
        following, events = self._beginning.begin(rest, observation, wanted)
        if phase.went_back:
            return following, events
        landing = footstep_event(observation.time, taken.sent.step, taken.step, landed)
        return following, (landing, *events)

    def reach(self, phase: StepSettle) -> Reach:
        """Returns both feet, with the body over the stance foot."""
        stance = phase.feet[phase.taken.stance]
        height = self._balance.height_over(stance, phase.taken)
        return Reach(height, phase.feet, list(enumerate(phase.feet)))

    def command_feet(
        self, phase: StepSettle, observation: Observation, cop: np.ndarray
    ) -> tuple[FootCommand, FootCommand]:
        """Keeps the stance foot planted and presses the new foot flat."""
        return self._balance.pressed(phase, observation, phase.taken.foot, cop)


def with_foot(
    feet: tuple[FootPose, FootPose], foot: int, pose: FootPose
) -> tuple[FootPose, FootPose]:
    """Returns the feet with another pose of one foot."""
    return (pose, feet[1]) if foot == 0 else (feet[0], pose)
