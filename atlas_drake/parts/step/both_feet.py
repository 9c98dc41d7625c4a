"""REST, SHIFT and SETTLE: both feet are down.

Computes each tick of these phases; ``tools`` begins and ends the steps.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import footstep_event
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.control.balance import feedback
from atlas_drake.control.feet.leg_kinematics import hips_from_com
from atlas_drake.control.feet.sole_motion import Pitch, at_rest, pitched_pose
from atlas_drake.frozen import replace
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.parts.step.phases import (
    Rest,
    StepSettle,
    StepShift,
    StepState,
    StepSwing,
)
from atlas_drake.parts.step.tools import Reach, StepPhaseControl, StepTools
from atlas_drake.support_polygon import SupportPolygon


class RestControl(StepPhaseControl[Rest]):
    """Stands over the middle of the feet until a step is requested."""

    def advance(
        self, phase: Rest, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Begins the requested step; after an abandoned step, only at rest."""
        if phase.gave_up and phase.elapsed < phase.shift.duration:
            return phase, ()
        return self._tools.begin(phase, observation, leaving)

    def reach(self, phase: Rest) -> Reach:
        """Returns both feet, with the body half-way between them."""
        return self._tools.reach_at_rest(phase.feet)

    def command_feet(
        self, phase: Rest, observation: Observation
    ) -> tuple[Rest, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted; a foot that just landed is pressed flat."""
        tools = self._tools
        if phase.touchdown_foot is None or not tools.is_early(phase):
            return phase, tools.balance.standing(observation)
        cop = self.cop(phase, observation)
        return phase, tools.touchdown(phase, observation, phase.touchdown_foot, cop)


class ShiftControl(StepPhaseControl[StepShift]):
    """Shifts the weight until the foot is unloaded, or abandons the step."""

    def __init__(self, tools: StepTools):
        super().__init__(tools)
        self._rules = tools.rules
        self._half_length = tools.planner.half_length

    def advance(
        self, phase: StepShift, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Lifts off, or abandons a step whose foot cannot be unloaded."""
        if self._is_ready(phase, observation):
            return self._lift_off(phase, observation), ()
        rules = self._rules
        late = phase.elapsed > phase.shift.duration + rules.longest_wait
        support = self.support(phase)
        outside = self._tools.dcm_outside(phase, observation, support)
        if late or outside > -rules.dcm_lost:
            # A disturbance acts on the robot.
            index = phase.progress.index
            text = f"step {index} is not taken: its foot cannot be unloaded"
            rest = self._tools.rest_after(phase, observation, phase.feet)
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
        now[step.foot] = pitched_pose(flat, self._heel(phase).angle, self._half_length)
        raised = pitched_pose(flat, phase.heel, self._half_length)
        later[step.foot] = (step.foot, raised)
        later.append((step.foot, step.pose))
        stance = phase.feet[phase.stance]
        return Reach(self._tools.height_over(stance, step), now, later)

    def command_feet(
        self, phase: StepShift, observation: Observation
    ) -> tuple[StepShift, tuple[FootCommand, FootCommand]]:
        """Unloads the leaving foot and raises its heel, after pressing a new foot."""
        tools, foot = self._tools, phase.step.foot
        cop = self.cop(phase, observation)
        heel = self._heel(phase)
        on_toes = heel.angle > 0.0
        landed = phase.touchdown_foot
        if landed is not None and tools.is_early(phase):
            return phase, tools.touchdown(phase, observation, landed, cop, on_toes)
        rest = 1.0 - phase.elapsed / phase.shift.duration
        load = max(rest / self._rules.unload_share, 0.01)
        load = max(load, tools.load_range(phase, foot, cop, on_toes)[0])
        if not on_toes:
            command = tools.balance.in_contact(observation, foot, load)
            return phase, tools.with_stance(observation, foot, command)
        reference = at_rest(phase.feet[foot]).pitched(heel, self._half_length)
        command = tools.balance.toeing_off(observation, foot, reference, load)
        return phase, tools.with_stance(observation, foot, command)

    def support(self, phase: StepShift) -> SupportPolygon:
        """Returns the present region of the CoP; a raised heel carries no load."""
        if self._heel(phase).angle == 0.0:
            return phase.support
        return self._tools.balance.support_on_toes(
            phase.feet[phase.stance], phase.feet[phase.step.foot]
        )

    def are_both_flat(self, phase: StepShift) -> bool:
        """Returns True if the heel is down."""
        return self._heel(phase).angle <= 0.0

    def _heel(self, phase: StepShift) -> Pitch:
        return phase.heel_motion(self._rules.heel_begins)

    def _is_ready(self, phase: StepShift, observation: Observation) -> bool:
        """Returns True if the foot is unloaded, and the DCM at the end of its shift."""
        if phase.elapsed < phase.shift.duration:
            return False
        load = observation.foot_force[phase.step.foot]
        if load > self._rules.still_loaded * self._tools.balance.weight:
            return False
        omega = self._tools.omega(observation, (phase.feet[phase.stance],))
        error = feedback.dcm(observation.terms, omega) - phase.shift.end
        return float(np.hypot(*error)) < self._rules.dcm_ready

    def _lift_off(self, phase: StepShift, observation: Observation) -> StepSwing:
        tools = self._tools
        return phase.become(
            StepSwing,
            support=tools.balance.support(phase.feet[phase.stance]),
            hips=hips_from_com(observation.terms, tools.planner.legs),
        )


class SettleControl(StepPhaseControl[StepSettle]):
    """Presses the new foot flat before the weight moves."""

    def advance(
        self, phase: StepSettle, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Ends the step, and begins the next step if one is requested."""
        if phase.elapsed < self._tools.rules.settle:
            return phase, ()
        step = phase.step
        landed = observation.foot_pose(step.foot)
        rest = self._tools.rest_after(
            phase, observation, with_foot(phase.feet, step.foot, landed)
        )
        following, events = self._tools.begin(rest, observation, leaving)
        if phase.went_back:
            return following, events
        landing = footstep_event(observation.time, phase.sent, step, landed)
        return following, (landing, *events)

    def reach(self, phase: StepSettle) -> Reach:
        """Returns both feet, with the body over the stance foot."""
        stance = phase.feet[phase.stance]
        height = self._tools.height_over(stance, phase.step)
        return Reach(height, phase.feet, list(enumerate(phase.feet)))

    def command_feet(
        self, phase: StepSettle, observation: Observation
    ) -> tuple[StepSettle, tuple[FootCommand, FootCommand]]:
        """Keeps the stance foot planted and presses the new foot flat."""
        foot, cop = phase.step.foot, self.cop(phase, observation)
        return phase, self._tools.touchdown(phase, observation, foot, cop)
