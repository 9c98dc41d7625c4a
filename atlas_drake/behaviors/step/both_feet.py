"""REST and SETTLE: both feet are down, and the next step may begin.

Computes each tick of these phases; the weight shift of a step is in ``shift``.
"""

from __future__ import annotations

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footstep_event import footstep_event
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.behaviors.step.beginning import StepBeginning
from atlas_drake.behaviors.step.phase_control import StepPhaseControl
from atlas_drake.behaviors.step.phases import Rest, StepSettle, StepState
from atlas_drake.behaviors.step.step_balance import Reach, StepBalance
from atlas_drake.messages.event import Event


class RestControl(StepPhaseControl[Rest]):
    """Stands over the middle of the feet until a step is requested."""

    def __init__(self, balance: StepBalance, beginning: StepBeginning):
        super().__init__(balance)
        self._beginning = beginning

    def advance(
        self, phase: Rest, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Begins the requested step; after an abandoned step, only at rest."""
        if phase.gave_up and phase.elapsed < phase.shift.duration:
            return phase, ()
        return self._beginning.begin(phase, observation, leaving)

    def reach(self, phase: Rest) -> Reach:
        """Returns both feet, with the body half-way between them."""
        return self._balance.reach_at_rest(phase.feet)

    def command_feet(
        self, phase: Rest, observation: Observation
    ) -> tuple[Rest, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted; a foot that just landed is pressed flat."""
        balance = self._balance
        if phase.fresh is None or not balance.is_fresh(phase):
            return phase, balance.planted(observation)
        cop = self.cop(phase, observation)
        return phase, balance.pressed(phase, observation, phase.fresh, cop)


class SettleControl(StepPhaseControl[StepSettle]):
    """Presses the new foot flat before the weight moves."""

    def __init__(self, balance: StepBalance, beginning: StepBeginning):
        super().__init__(balance)
        self._beginning = beginning

    def advance(
        self, phase: StepSettle, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Ends the step, and begins the next step if one is requested."""
        if phase.elapsed < self._balance.rules.settle:
            return phase, ()
        taken = phase.taken
        landed = observation.foot_pose(taken.foot)
        rest = self._beginning.rest(
            phase, observation, with_foot(phase.feet, taken.foot, landed)
        )
        following, events = self._beginning.begin(rest, observation, leaving)
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
        self, phase: StepSettle, observation: Observation
    ) -> tuple[StepSettle, tuple[FootCommand, FootCommand]]:
        """Keeps the stance foot planted and presses the new foot flat."""
        foot, cop = phase.taken.foot, self.cop(phase, observation)
        return phase, self._balance.pressed(phase, observation, foot, cop)
