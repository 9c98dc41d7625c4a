"""WALK: dynamic walking over the steps of messages, then back to STAND.

Its phases are TRANSFER of the weight to a stance foot and SWING of the other foot, for
each step, then SETTLE over both feet. Read ``transfer``, ``swing``, ``settle``,
``transitions``, ``steps``, ``gait``, in this order.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.behaviors.phases import set_down
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phase import Decision, WalkPhase, WalkTick
from atlas_drake.behaviors.walk.steps import (
    WalkProgress,
    read_message,
    steps_asked_for,
    with_warnings,
)
from atlas_drake.behaviors.walk.swing import Swing
from atlas_drake.behaviors.walk.transfer import Transfer
from atlas_drake.behaviors.walk.transitions import next_phase, shift_weight
from atlas_drake.behaviors.walk.trunk import is_quick, trunk_target
from atlas_drake.control.balance.dcm_plan import Pendulum
from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.balance.foothold import ground_below
from atlas_drake.frozen import replace
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS, AtlasBehaviorWalkFeedback
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import FootPose


class Walk(BehaviorProtocol):
    """Walks over given footsteps. Holds constants only."""

    def __init__(self, tools: BehaviorTools, config: WalkConfig):
        self._balance = tools.balance
        self._config = config
        self._gait = tools.gait
        self._nominal_height = tools.nominal_height
        self._rates = replace(tools.rates, height=config.rules.height_rate)
        omega = pendulum_frequency(tools.nominal_height)
        self._pendulum = Pendulum(omega, tools.balance.swing_inertia)

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Transfer:
        """Begins to shift the weight to the first stance foot."""
        tick = self._tick(observation, body)
        airborne = self._balance.airborne(observation)
        feet = set_down(observation.foot_poses, airborne)
        params = request.command.walk_params
        pending = steps_asked_for((), params, feet, 1, self._gait)
        first = pending[0].index if pending else 1
        progress = WalkProgress(feet, feet, pending, first, request, self._config)
        down = feet if airborne is None else (feet[1 - airborne],)
        support = self._balance.support(*down)
        phase = shift_weight(progress, tick.dcm, support.clamp(tick.dcm), tick)
        return replace(phase, support=support)

    def update(
        self,
        phase: WalkPhase,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Walks for one tick; ``leaving`` drops the steps that have not begun."""
        tick, before = self._tick(observation, body, leaving), phase
        progress, news = self._read(phase, tick, request)
        phase = replace(
            phase,
            progress=progress,
            elapsed=phase.elapsed + tick.dt,
            plan_time=phase.plan_time + tick.dt,
        )
        phase = phase.on_what_carries(tick)
        decision = phase.decide(tick)
        phase, events = next_phase(phase, decision, tick)
        reference = phase.dcm_reference()
        phase, feet = phase.command_feet(tick)
        target = trunk_target(phase, tick, self._nominal_height)
        body = observation.advance_body(body, target, self._rates)
        command = self._balance.command(
            observation,
            body,
            reference,
            self._pendulum.omega,
            phase.support,
            feet,
            quick=is_quick(phase, tick),
        )
        return Outcome(
            state=phase,
            body=body,
            command=command,
            finished=decision is Decision.FINISH,
            status_flags=phase.status_flags(leaving),
            events=news + events,
            landing=self._landing(before, phase),
        )

    def plan(self, phase: WalkPhase, com: np.ndarray, omega: float) -> Plan:
        """Returns the references of the DCM plan and the coming footsteps."""
        progress = phase.progress
        in_air = () if progress.in_air is None else (progress.in_air,)
        steps = (*in_air, *progress.known)
        return phase.plan_of(phase.dcm_reference(), phase.plan.omega, steps)

    def paths(self, phase: WalkPhase, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the paths of the DCM plan and of the present swing."""
        return phase.paths(com, self._config.swing)

    def feedback(
        self, phase: WalkPhase, status_flags: int
    ) -> AtlasBehaviorWalkFeedback:
        """Returns timing and the steps as they will be executed."""
        progress = phase.progress
        first_unknown = progress.next_index + len(progress.known)
        return AtlasBehaviorWalkFeedback(
            t_step_rem=phase.time_to_touchdown(self._config.timing),
            current_step_index=progress.last_index,
            next_step_index_needed=min(
                first_unknown, progress.last_index + NUM_REQUIRED_WALK_STEPS
            ),
            status_flags=status_flags,
            step_queue_saturated=list(progress.preview.reported),
        )

    def _tick(
        self, observation: Observation, body: BodyReference, leaving: bool = False
    ) -> WalkTick:
        """Makes what the phases read in a tick."""
        return WalkTick(
            observation, body, leaving, self._balance, self._pendulum, self._config
        )

    def _read(
        self, phase: WalkPhase, tick: WalkTick, request: BehaviorRequest
    ) -> tuple[WalkProgress, tuple[Event, ...]]:
        """Reads a new message; a walk that is left drops the steps not begun.

        Steps may be out of reach since a message has changed them, or since the feet
        were measured as the phase began.
        """
        progress = phase.progress
        if not tick.leaving:
            progress = read_message(progress, request, self._gait)
        elif progress.pending:
            progress = replace(progress, pending=())
        if phase.elapsed == 0.0 or progress is not phase.progress:
            return with_warnings(progress, tick.observation.time)
        return progress, ()

    def _landing(
        self, before: WalkPhase, phase: WalkPhase
    ) -> tuple[int, FootPose] | None:
        """Returns foot and planned ground once a landed sole is, or should be, flat."""
        foot = phase.progress.last_foot
        if foot is None or isinstance(phase, Swing):
            return None
        if isinstance(phase, Transfer) and phase.landed != 0.0:
            flat_after = self._config.roll.flat_after
            is_flat = before.elapsed < flat_after <= phase.elapsed
        else:
            is_flat = isinstance(before, Swing)
        if not is_flat:
            return None
        return foot, ground_below(phase.progress.feet[foot], phase.progress.aimed[foot])
