"""SHIFT, TRANSFER and SETTLE: both feet are down, until lift-off or the walk's end.

Computes each tick of these phases; ``planner`` makes the plans that they follow.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import partial_event
from atlas_drake.behaviors.phases import PhaseControl, on_present_parts, with_foot
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phases import (
    FinalTransfer,
    InitialTransfer,
    Transfer,
    WalkPhase,
    WalkState,
    WalkSwing,
)
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.control.balance import feedback
from atlas_drake.control.feet.foot_roll import falling
from atlas_drake.control.feet.sole_motion import FLAT, at_rest
from atlas_drake.frozen import replace
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import LEFT, RIGHT

P = TypeVar("P", bound=WalkPhase)
SHOWN = 10
"""Number of steps that an event names one by one."""


class DoubleSupport(PhaseControl[InitialTransfer | Transfer]):
    """Shifts the weight and determines when a foot lifts off."""

    def __init__(self, balance: Balance, planner: WalkPlanner, config: WalkConfig):
        self._balance = balance
        self._planner = planner
        self._rules = config.rules
        self._roll = config.roll
        self._half_length = balance.robot.file.sole.length / 2
        self._legs = balance.robot.legs

    def advance(
        self, phase: InitialTransfer | Transfer, observation: Observation, leaving: bool
    ) -> tuple[WalkState, tuple[Event, ...]]:
        """Lifts off when the DCM is ready; settles if no step can be taken."""
        planner = self._planner
        toes = isinstance(phase, Transfer) and phase.toe_off
        on_toes, flat_after = phase.unloading if toes else None, self._roll.flat_after
        phase = on_what_carries(phase, observation, planner, flat_after, on_toes)
        coming = planner.coming(phase.progress)
        first = coming[0].foot if coming else phase.unloading
        if isinstance(phase, InitialTransfer) and first != phase.unloading:
            # A message has changed the first foot: the weight shifts anew.
            now = phase.planned
            return planner.initial_transfer(phase.progress, now.dcm, now.cop), ()
        lost = is_dcm_lost(phase, observation, self._rules.dcm_lost)
        if lost and not planner.coming(phase.progress):
            return planner.recover(phase.progress, observation)
        if lost and not phase.brought_forward:
            if isinstance(phase, Transfer):
                again = planner.step_again(phase.progress, observation)
                if again is not None:
                    return again
            soonest = phase.elapsed + self._rules.hurried_transfer
            duration = min(phase.duration, soonest)
            phase = replace(phase, duration=duration, brought_forward=True)
        if phase.elapsed < phase.duration:
            return phase, ()
        if not planner.coming(phase.progress):
            return planner.final_transfer(phase.progress, phase.planned.cop), ()
        late = phase.elapsed - phase.duration
        patient = (
            late < self._rules.longest_wait
            and not lost
            and not self._is_stretched(phase, observation)
        )
        if patient and not self._is_dcm_ready(phase, observation):
            # Hold the plan at the moment of lift-off until the DCM is near it.
            return replace(phase, plan_time=phase.plan_time - observation.dt), ()
        # Measure the feet again: since touchdown the load has turned the soles flat.
        feet, pitch = observation.foot_poses, FLAT
        if isinstance(phase, Transfer) and phase.toe_off:
            # The foot on its toes is known from when it was flat.
            foot = phase.unloading
            feet = with_foot(feet, foot, phase.progress.feet[foot])
            on_time = late <= observation.dt
            pitch = phase.leaving_pitch(phase.duration if on_time else phase.elapsed)
        phase = replace(phase, progress=replace(phase.progress, feet=feet))
        phase, news = planner.warn(phase, observation.time)
        if not planner.coming(phase.progress):
            # The step cannot be taken from the present poses of the feet.
            return planner.final_transfer(phase.progress, phase.planned.cop), news
        # Shorten the swing by the delay of lift-off, at most by one tick.
        swing = planner.swing(phase.progress, min(late, observation.dt), pitch)
        stance = 1 - swing.step.foot
        share = self._balance.carrying_share(phase.progress.feet[stance])
        index = phase.progress.last_index
        return swing, (*news, *partial_event(observation.time, index, stance, share))

    def command_feet(
        self, phase: InitialTransfer | Transfer, observation: Observation
    ) -> tuple[InitialTransfer | Transfer, tuple[FootCommand, FootCommand]]:
        """Unloads the foot that lifts off next; the other one stays, or rolls flat."""
        commands = [self._command(phase, observation, foot) for foot in (LEFT, RIGHT)]
        return phase, (commands[LEFT], commands[RIGHT])

    def _command(
        self, phase: InitialTransfer | Transfer, observation: Observation, foot: int
    ) -> FootCommand:
        leaves, load = foot == phase.unloading, math.inf
        if leaves and not phase.waiting:
            left_share = 1.0 - phase.elapsed / phase.duration
            load = min(max(left_share / self._rules.unload_share, 0.01), 1.0)
        if isinstance(phase, Transfer):
            flat = at_rest(phase.progress.feet[foot])
            if leaves and phase.toe_off:
                pitch = phase.leaving_pitch(phase.elapsed)
                raised = flat.pitched(pitch, self._half_length)
                return self._balance.toeing_off(observation, foot, raised, load)
            flat_after = self._roll.flat_after
            if not leaves and phase.landed and phase.elapsed < flat_after:
                pitch = falling(phase.landed, flat_after, phase.elapsed)
                edge = math.copysign(self._half_length, phase.landed)
                lowered = flat.pitched(pitch, edge)
                return self._balance.rolling_flat(observation, foot, lowered, edge > 0)
        return self._balance.in_contact(observation, foot, load)

    def _is_dcm_ready(
        self, phase: InitialTransfer | Transfer, observation: Observation
    ) -> bool:
        """Returns True if the DCM is near enough to its plan for single support."""
        dcm = feedback.dcm(observation.terms, phase.plan.omega)
        return float(np.hypot(*(dcm - phase.planned.dcm))) < self._rules.dcm_ready

    def _is_stretched(
        self, phase: InitialTransfer | Transfer, observation: Observation
    ) -> bool:
        """Returns True if the leg that lifts off next is at its full length.

        The straight leg of a planted foot holds the pelvis back, so that waiting does
        not bring the DCM nearer.
        """
        foot = phase.unloading
        return foot is not None and (
            self._legs[foot].flexion(observation.terms.q[self._legs[foot].knee])
            < self._rules.straight_flexion
        )


class Settling(PhaseControl[FinalTransfer]):
    """Stands still until the walk is over or new steps arrive.

    If the DCM is lost, a step catches it; once the robot is at rest, the other foot is
    put beside the foot that made that step.
    """

    def __init__(self, balance: Balance, planner: WalkPlanner, config: WalkConfig):
        self._balance = balance
        self._planner = planner
        self._config = config

    def advance(
        self, phase: FinalTransfer, observation: Observation, leaving: bool
    ) -> tuple[FinalTransfer | InitialTransfer | WalkSwing, tuple[Event, ...]]:
        """Begins a new weight shift if steps arrived, or the feet stand apart."""
        planner, now = self._planner, phase.planned
        flat_after = self._config.roll.flat_after
        phase = on_what_carries(phase, observation, planner, flat_after)
        progress = phase.progress
        if is_dcm_lost(phase, observation, self._config.rules.dcm_lost):
            return planner.recover(progress, observation)
        if self.is_over(phase, observation):
            square_up = planner.square_up(progress)
            if square_up is not None:
                return planner.initial_transfer(square_up, now.dcm, now.cop), ()
        if not planner.coming(progress):
            return phase, ()
        return planner.initial_transfer(progress, now.dcm, now.cop), ()

    def command_feet(
        self, phase: FinalTransfer, observation: Observation
    ) -> tuple[FinalTransfer, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted."""
        return phase, self._balance.standing(observation)

    def is_over(self, phase: FinalTransfer, observation: Observation) -> bool:
        """Returns True if the robot is at rest."""
        speed = float(np.abs(observation.terms.com_velocity).max())
        over = phase.elapsed > phase.duration + self._config.timing.rest
        return over and speed < self._config.rules.rest_speed


def on_what_carries(
    phase: P,
    observation: Observation,
    planner: WalkPlanner,
    flat_after: float,
    on_toes: int | None = None,
) -> P:
    """Returns the phase on the parts of the soles that carry now.

    For ``flat_after`` [s] a landed sole counts as whole: its edge lands first.
    """
    feet = on_present_parts(phase.progress.feet, observation)
    if phase.elapsed < flat_after or feet is phase.progress.feet:
        return phase
    progress = replace(phase.progress, feet=feet)
    return replace(phase, progress=progress, support=planner.support(progress, on_toes))


def is_dcm_lost(phase: WalkPhase, observation: Observation, margin: float) -> bool:
    """Returns True if no CoP between the feet brings the DCM back to its plan.

    ``margin`` is a distance outside the support polygon, beyond that of the plan [m].
    """
    support = phase.support
    outside = support.distance_outside(
        feedback.dcm(observation.terms, phase.plan.omega)
    )
    # In most ticks it is inside, and the plan need not be evaluated.
    return outside > margin and (
        outside - support.distance_outside(phase.planned.dcm) > margin
    )


def steps_left_out(
    phase: FinalTransfer, time: float, leaving: bool
) -> tuple[Event, ...]:
    """Makes an event of the steps that the walk leaves out, if any."""
    progress = phase.progress
    if progress.pending:
        left = [step.index for step in progress.pending]
        text = f"WALK ends without the steps {', '.join(map(str, left[:SHOWN]))}"
        if len(left) > SHOWN:
            text += f" and {len(left) - SHOWN} more"
        if phase.obstacle:
            text += f": {phase.obstacle}"
    elif progress.last_foot is None and not leaving:
        text = "WALK ends without a step: walk_params.step_queue has none"
    else:
        return ()
    return (Event(time, STEPS_LEFT, text),)
