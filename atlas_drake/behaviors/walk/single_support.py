"""SWING: one foot is in the air, and balance may move its landing place.

Computes each tick of the phase; ``planner`` makes the plans that it follows.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import contact_event, footstep_event
from atlas_drake.behaviors.phases import PhaseControl, on_present_parts, with_foot
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phases import WalkState, WalkSwing
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.step_adjustment import (
    SingleSupportState,
    touchdown_for_balance,
)
from atlas_drake.control.feet.sole_motion import pitch_from, pitched_pose
from atlas_drake.control.feet.swing_foot import advance_swing
from atlas_drake.frozen import replace
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import LEFT


class SingleSupport(PhaseControl[WalkSwing]):
    """Moves the swing foot to a landing place that keeps balance; detects touchdown."""

    def __init__(self, balance: Balance, planner: WalkPlanner, config: WalkConfig):
        self._balance = balance
        self._planner = planner
        self._rules = config.rules
        self._profile = config.swing
        self._adjustment = config.adjustment
        loose = config.slack.loosen(config.limits)
        self._limits = loose.extended(config.adjustment.stretch)
        self._touchdown_force = config.rules.touchdown_force * balance.weight
        self._landing_force = config.rules.landing_force * balance.weight

    def advance(
        self, phase: WalkSwing, observation: Observation, leaving: bool
    ) -> tuple[WalkState, tuple[Event, ...]]:
        """Ends the swing with touchdown; keeps the CoP on what of the sole carries."""
        stance = 1 - phase.step.foot
        feet = on_present_parts(phase.progress.feet, observation)
        if feet[stance] is not phase.progress.feet[stance]:
            feet = with_foot(phase.progress.feet, stance, feet[stance])
            progress = replace(phase.progress, feet=feet)
            support = self._balance.support(feet[stance])
            phase = replace(phase, progress=progress, support=support)
        least = self._touchdown_force
        if phase.duration - phase.elapsed < self._rules.frozen_end:
            least = min(least, self._landing_force)
        touched = phase.motion.progress >= self._rules.earliest_touchdown and (
            observation.foot_force[phase.step.foot] > least
            or self._gives_way(phase, observation)
        )
        return self._touch_down(phase, observation) if touched else (phase, ())

    def command_feet(
        self, phase: WalkSwing, observation: Observation
    ) -> tuple[WalkSwing, tuple[FootCommand, FootCommand]]:
        """Advances the swing foot towards a landing place that keeps balance."""
        phase = self._adjust_step(phase, observation)
        motion, reference = advance_swing(
            phase.motion, phase.step, self._profile, observation.dt
        )
        foot = phase.step.foot
        stance = self._balance.in_contact(observation, 1 - foot)
        swing = self._balance.swinging(observation, foot, reference)
        feet = (swing, stance) if foot == LEFT else (stance, swing)
        return replace(phase, motion=motion), feet

    def _gives_way(self, phase: WalkSwing, observation: Observation) -> bool:
        """Returns True if the ground turns a sole that lands on its toes.

        Its ankle yields to forces that are too small to count.
        """
        motion = phase.motion
        if motion.landing_pitch <= 0.0 or motion.remaining > self._rules.frozen_end:
            return False
        pose = observation.foot_pose(phase.step.foot)
        turned = motion.pitch.angle - pitch_from(pose, phase.step.normal)
        return turned > self._rules.landing_turn

    def _touch_down(
        self, phase: WalkSwing, observation: Observation
    ) -> tuple[WalkState, tuple[Event, ...]]:
        step, landed = phase.step, observation.foot_pose(phase.step.foot)
        pitch, aimed = 0.0, phase.motion.landing_pitch
        if aimed:
            sign = math.copysign(1.0, aimed)
            pitch = sign * max(sign * pitch_from(landed, step.normal), 0.0)
            # The foot rolls flat about heel or toes, and counts as flat from now on.
            landed = pitched_pose(landed, -pitch, sign * phase.motion.half_length)
        progress = replace(
            phase.progress,
            feet=with_foot(phase.progress.feet, step.foot, landed),
            aimed=with_foot(phase.progress.aimed, step.foot, step.pose),
        )
        early = phase.duration - phase.elapsed
        # A step of the walk's own was not commanded to any other place.
        sent = step if phase.progress.last_was_recovery else phase.sent
        time = observation.time
        events = (
            footstep_event(time, sent, step, landed),
            *contact_event(time, step, early),
        )
        cop = phase.planned.cop
        landing = self._planner.land(progress, cop, early, pitch, phase.stops)
        return landing, events

    def _adjust_step(self, phase: WalkSwing, observation: Observation) -> WalkSwing:
        """Moves the landing, in place and time, when the ankles cannot hold the DCM."""
        remaining = phase.duration - phase.elapsed
        if remaining < self._rules.frozen_end:
            return phase
        step, omega, planned = phase.step, phase.plan.omega, phase.planned
        state = SingleSupportState(
            dcm=feedback.dcm(observation.terms, omega),
            planned_dcm=planned.dcm,
            cop=planned.cop,
            omega=omega,
            remaining=remaining,
            sensitivity=phase.sensitivity,
            stance=phase.progress.feet[1 - step.foot],
        )
        motion = phase.motion
        moved, left = touchdown_for_balance(
            step, state, motion.progress, motion.xy, self._adjustment, self._limits
        )
        shift = float(np.abs(moved.p_WF - step.p_WF).max())
        if shift < self._rules.replan_shift and left == remaining:
            return phase
        return self._planner.move_landing(phase, moved, remaining - left)
