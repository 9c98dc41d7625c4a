"""SWING and LOWER: one foot is in the air, and the body stands over the other.

Computes each tick of these phases; ``tools`` plans the swing before lift-off.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import contact_event
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.frozen import replace
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.parts.step.phases import (
    InAir,
    Lower,
    StepSettle,
    StepState,
    StepSwing,
)
from atlas_drake.parts.step.step_swing import plan_step_swing
from atlas_drake.parts.step.tools import Reach, StepPhaseControl, StepTools
from atlas_drake.parts.step.weight_shift import WeightShift

P = TypeVar("P", bound=InAir)


class InAirControl(StepPhaseControl[P]):
    """Common part of the phases with one foot in the air."""

    def reach(self, phase: P) -> Reach:
        """Returns the stance foot and the foothold, lower if no ground was found."""
        stance = phase.feet[phase.stance]
        feet = with_foot(phase.feet, phase.step.foot, phase.foothold())
        height = self._tools.height_over(stance, phase.step)
        return Reach(height, feet, list(enumerate(feet)))

    def command_feet(
        self, phase: P, observation: Observation
    ) -> tuple[P, tuple[FootCommand, FootCommand]]:
        """Keeps the stance foot planted and moves the other foot along its swing."""
        foot, swing = phase.step.foot, phase.swing
        reference = swing.evaluate(phase.elapsed)
        command = self._tools.balance.swinging(observation, foot, reference)
        return phase, self._tools.with_stance(observation, foot, command)

    def are_both_flat(self, phase: P) -> bool:
        """Returns False: one foot is in the air."""
        return False


class SwingControl(InAirControl[StepSwing]):
    """Moves the foot up and across."""

    def advance(
        self, phase: StepSwing, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Begins to lower the foot when it is above its foothold."""
        if not phase.swing.is_lowering(phase.elapsed):
            return phase, ()
        return self._begin_to_lower(phase, observation), ()

    def _begin_to_lower(self, phase: StepSwing, observation: Observation) -> Lower:
        """Leans into the step by the requested distance while the foot comes down.

        The distance is limited so that the standing foot can still bring the body back
        if the other foot finds no ground.
        """
        lower = phase.become(Lower, elapsed=phase.elapsed)
        step, support = phase.step, phase.support
        distance = step.action.step_end_dist
        if distance == 0.0:
            return lower
        over, stance = phase.shift.end, phase.feet[phase.stance]
        way = step.p_WF[:2] - stance.p_WF[:2]
        lean = distance * way / np.hypot(*way)
        omega = self._tools.omega(observation, (stance,))
        rules = self._tools.rules
        for share in np.linspace(1.0, 0.0, 11):
            shift = WeightShift(over, over + share * lean, phase.swing.lower)
            inside = -support.distance_outside(shift.end)
            # The CoP of the motion must lie within the standing sole, too.
            pushed = -shift.cop_outside(support, omega)
            if inside >= rules.lean_inside and pushed >= rules.cop_inside:
                break
        return replace(lower, shift=shift, shift_time=0.0)


class LowerControl(InAirControl[Lower]):
    """Lowers the foot until it touches the ground."""

    def __init__(self, tools: StepTools):
        super().__init__(tools)
        self._touchdown_force = tools.rules.touchdown_force * tools.balance.weight

    def advance(
        self, phase: Lower, observation: Observation, leaving: bool
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Ends the phase at touchdown; a foot that finds no ground returns."""
        if observation.foot_force[phase.step.foot] > self._touchdown_force:
            early = phase.swing.duration - phase.elapsed
            touched = contact_event(observation.time, phase.step, early)
            return self._touch_down(phase, observation), touched
        if phase.swing.has_missed(phase.elapsed):
            return self._step_back(phase, observation)
        return phase, ()

    def _touch_down(self, phase: Lower, observation: Observation) -> StepSettle:
        """Presses the foot flat, because perhaps only an edge touched the ground."""
        foot = phase.step.foot
        feet = with_foot(phase.feet, foot, observation.foot_pose(foot))
        support = self._tools.balance.support(*feet)
        return phase.become(StepSettle, feet=feet, support=support)

    def _step_back(
        self, phase: Lower, observation: Observation
    ) -> tuple[StepSwing, tuple[Event, ...]]:
        """Returns the foot to its lift-off pose, where ground is known."""
        foot, action = phase.step.foot, phase.step.action
        home = phase.feet[foot]
        here = observation.foot_pose(foot)
        swing = plan_step_swing(
            here,
            here,
            home,
            action.lift_height,
            action.swing_height,
            action.step_duration,
            action.max_foot_vel,
            self._tools.profile,
        )
        normal = home.R_WF[:, 2].copy()
        step = replace(phase.step, p_WF=home.p_WF, yaw=home.yaw, normal=normal)
        back = phase.become(StepSwing, step=step, swing=swing, went_back=True)
        if action.step_end_dist != 0.0:
            # Bring the body back over the standing foot, from which it leant.
            over, stance = phase.shift.start, (phase.feet[phase.stance],)
            quick = replace(action, sway_duration=swing.lower)
            shift = self._tools.shift_to(
                observation, over, quick, stance, phase.support
            )
            upright = replace(step, action=replace(action, step_end_dist=0.0))
            back = replace(back, step=upright, shift=shift, shift_time=0.0)
        text = f"step {step.index} found no ground; its foot returns"
        return back, (Event(observation.time, STEPS_LEFT, text),)
