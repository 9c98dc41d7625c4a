"""REST, SHIFT and SETTLE: both feet are down.

Computes each tick of these phases; the beginning of a step is in ``beginning``.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import footstep_event
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.behaviors.step.beginning import StepBeginning
from atlas_drake.behaviors.step.phases import (
    Rest,
    StepSettle,
    StepShift,
    StepState,
    StepSwing,
)
from atlas_drake.behaviors.step.step_balance import (
    Reach,
    StepBalance,
    StepPhaseControl,
)
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.leg_kinematics import hips_from_com
from atlas_drake.control.feet.sole import on_toes, toe_off_reference
from atlas_drake.frozen import replace
from atlas_drake.messages.event import STEPS_LEFT, Event


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
            return phase, balance.balance.standing(observation)
        cop = self.cop(phase, observation)
        return phase, balance.pressed(phase, observation, phase.fresh, cop)


class ShiftControl(StepPhaseControl[StepShift]):
    """Shifts the weight until the foot is unloaded, or abandons the step."""

    def __init__(self, balance: StepBalance, beginning: StepBeginning):
        super().__init__(balance)
        self._beginning = beginning
        self._rules = balance.rules
        self._half_length = balance.planner.half_length
        self._weight = balance.balance.weight

    def advance(
        self, phase: StepShift, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Lifts off, or abandons a step whose foot cannot be unloaded."""
        if self._is_ready(phase, observation):
            return self._lift_off(phase, observation), ()
        rules = self._rules
        late = phase.elapsed > phase.shift.duration + rules.longest_wait
        support = self.support(phase)
        outside = self._balance.dcm_outside(phase, observation, support)
        if late or outside > -rules.dcm_lost:
            # A disturbance acts on the robot.
            index = phase.progress.index
            text = f"step {index} is not taken: its foot cannot be unloaded"
            rest = self._beginning.rest(phase, observation, phase.feet)
            event = Event(observation.time, STEPS_LEFT, text)
            return replace(rest, gave_up=True), (event,)
        return phase, ()

    def reach(self, phase: StepShift) -> Reach:
        """Returns the feet, the leaving one on its toes, and the next foothold.

        The body is low enough for the landing, so that it moves up or down only once.
        """
        step, now = phase.step, list(phase.feet)
        later = list(enumerate(now))
        flat = now[step.foot]
        now[step.foot] = on_toes(flat, self._heel(phase)[0], self._half_length)
        raised = on_toes(flat, phase.heel, self._half_length)
        later[step.foot] = (step.foot, raised)
        later.append((step.foot, step.pose))
        stance = phase.feet[phase.stance]
        return Reach(self._balance.height_over(stance, step), now, later)

    def command_feet(
        self, phase: StepShift, observation: Observation
    ) -> tuple[StepShift, tuple[FootCommand, FootCommand]]:
        """Unloads the leaving foot and raises its heel, after pressing a new foot."""
        balance, foot = self._balance, phase.step.foot
        cop = self.cop(phase, observation)
        angle, rate, acceleration = self._heel(phase)
        on_toes = angle > 0.0
        if phase.fresh is not None and balance.is_fresh(phase):
            feet = balance.pressed(phase, observation, phase.fresh, cop, on_toes)
            return phase, feet
        rest = 1.0 - phase.elapsed / phase.shift.duration
        load = max(rest / self._rules.unload_share, 0.01)
        load = max(load, balance.load_range(phase, foot, cop, on_toes)[0])
        if not on_toes:
            command = balance.balance.planted(observation, foot, load)
            return phase, balance.planted(observation, foot, command)
        reference = toe_off_reference(
            phase.feet[foot], angle, rate, acceleration, self._half_length
        )
        command = balance.balance.toeing_off(observation, foot, reference, load)
        return phase, balance.planted(observation, foot, command)

    def support(self, phase: StepShift) -> SupportPolygon:
        """Returns the present region of the CoP; a raised heel carries no load."""
        if self._heel(phase)[0] == 0.0:
            return phase.support
        return self._balance.balance.support_on_toes(
            phase.feet[phase.stance], phase.feet[phase.step.foot]
        )

    def are_both_flat(self, phase: StepShift) -> bool:
        """Returns True if the heel is down."""
        return self._heel(phase)[0] <= 0.0

    def _heel(self, phase: StepShift) -> tuple[float, float, float]:
        return phase.heel_motion(self._rules.heel_begins)

    def _is_ready(self, phase: StepShift, observation: Observation) -> bool:
        """Returns True if the foot is unloaded, and the DCM at the end of its shift."""
        if phase.elapsed < phase.shift.duration:
            return False
        load = observation.foot_force[phase.step.foot]
        if load > self._rules.still_loaded * self._weight:
            return False
        omega = self._balance.omega(observation, (phase.feet[phase.stance],))
        error = feedback.dcm(observation.terms, omega) - phase.shift.end
        return float(np.hypot(*error)) < self._rules.dcm_ready

    def _lift_off(self, phase: StepShift, observation: Observation) -> StepSwing:
        balance = self._balance
        return StepSwing(
            progress=phase.progress,
            feet=phase.feet,
            support=balance.balance.support(phase.feet[phase.stance]),
            hips=hips_from_com(observation.terms, balance.planner.legs),
            shift=phase.shift,
            shift_time=phase.shift_time,
            lean=phase.lean,
            sent=phase.sent,
            step=phase.step,
            swing=phase.swing,
        )


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
        step = phase.step
        landed = observation.foot_pose(step.foot)
        rest = self._beginning.rest(
            phase, observation, with_foot(phase.feet, step.foot, landed)
        )
        following, events = self._beginning.begin(rest, observation, leaving)
        if phase.went_back:
            return following, events
        landing = footstep_event(observation.time, phase.sent, step, landed)
        return following, (landing, *events)

    def reach(self, phase: StepSettle) -> Reach:
        """Returns both feet, with the body over the stance foot."""
        stance = phase.feet[phase.stance]
        height = self._balance.height_over(stance, phase.step)
        return Reach(height, phase.feet, list(enumerate(phase.feet)))

    def command_feet(
        self, phase: StepSettle, observation: Observation
    ) -> tuple[StepSettle, tuple[FootCommand, FootCommand]]:
        """Keeps the stance foot planted and presses the new foot flat."""
        foot, cop = phase.step.foot, self.cop(phase, observation)
        return phase, self._balance.pressed(phase, observation, foot, cop)
