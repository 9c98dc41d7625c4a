"""WALK: dynamic walking over the steps that messages bring, then back to STAND.

Phases: SHIFT (weight over the first stance foot), then SWING and TRANSFER for each
step, then SETTLE over both feet. The DCM plan is made anew at every change of phase
from where the feet really are, and within a swing when balance asks for another
landing place.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FULL_LOAD, Balance, FootCommand
from atlas_drake.behaviors.base import Observation, Outcome
from atlas_drake.behaviors.body_reference import (
    BodyRates,
    BodyReference,
    BodyTarget,
    advance_body,
)
from atlas_drake.behaviors.footstep_event import footstep_event
from atlas_drake.behaviors.step.queue import replaced, step_data_from
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.gait import (
    begun_at,
    landing_sensitivity,
    plan_walk,
    stance_cop,
)
from atlas_drake.behaviors.walk.memory import Phase, WalkMemory
from atlas_drake.behaviors.walk.outlook import (
    LOOK_AHEAD,
    Outlook,
    look_ahead,
    subject,
    time_to_touchdown,
    warnings_about,
)
from atlas_drake.behaviors.walk.preview import walk_plan
from atlas_drake.behaviors.walk.steps import feet_to_come, steps_asked_for
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.step_adjustment import step_shift
from atlas_drake.control.feet.footstep import (
    LEFT,
    Footstep,
    saturate,
)
from atlas_drake.control.feet.swing_foot import (
    SwingReference,
    advance_swing,
    begin_swing,
)
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
)
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.planning.footholds import Gait

_UPRIGHT = np.zeros(2)


class Walk:
    """Walks over given footsteps."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        rates: BodyRates,
        config: WalkConfig | None = None,
    ):
        """Walks with the center of mass ``nominal_height`` [m] above the soles."""
        self._balance = balance
        self._nominal_height = nominal_height
        self._rates = rates
        config = config or WalkConfig()
        self._timing = balance.robot.file.gait_timing
        self._limits = balance.robot.file.walk_limits
        self._slack = config.slack
        self._loose_limits = self._slack.loosen(self._limits)
        self._adjustment = config.adjustment
        self._profile = config.swing
        self._rules = config.rules
        self._gait = Gait.of(balance.robot)
        legs = balance.robot.legs
        self._knees = [leg.knee for leg in legs]
        self._straight_knees = [
            leg.straight + self._rules.straight_flexion for leg in legs
        ]
        self._touchdown_force = self._rules.touchdown_force * balance.weight

    def enter(
        self,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
    ) -> WalkMemory:
        """Begins to shift the weight to the first stance foot."""
        feet = (seen.foot_pose(0), seen.foot_pose(1))
        params = request.walk_params
        pending = steps_asked_for((), params, feet, 1, self._gait)
        first = pending[0].index if pending else 1
        omega = feedback.pendulum_frequency(self._nominal_height)
        memory = WalkMemory(
            phase=Phase.SHIFT,
            elapsed=0.0,
            duration=self._timing.first_shift,
            feet=feet,
            aimed=feet,
            pending=pending,
            current=None,
            commanded=None,
            swing=None,
            plan=None,  # type: ignore[arg-type]  # set on the next line
            plan_time=0.0,
            unloading=None,
            sensitivity=1.0,
            support=self._balance.support(*feet),
            omega=omega,
            next_index=first,
            seen_params=params,
        )
        dcm = feedback.dcm(seen.terms, omega)
        memory = self._replan(memory, memory.support.clamp(dcm), memory.duration)
        return replace(memory, plan=begun_at(memory.plan, dcm, memory.support))

    def update(
        self,
        memory: WalkMemory,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
        leaving: bool,
    ) -> Outcome:
        """One tick of walking; ``leaving`` drops the steps that have not begun."""
        before = memory
        if leaving:
            memory = self._leave(memory)
        else:
            memory = self._read_queue(memory, request)
        memory = replace(
            memory,
            elapsed=memory.elapsed + seen.dt,
            plan_time=memory.plan_time + seen.dt,
        )
        memory, events = self._change_phase(memory, seen)
        if before.elapsed == 0.0 or memory.pending is not before.pending:
            memory, news = self._tell(memory, seen.time)
            events = (*events, *news)
        swing_reference = None
        if memory.swinging:
            memory = self._adjust_step(memory, seen)
            swing, swing_reference = advance_swing(
                memory.swing_in_progress, memory.step, self._profile, seen.dt
            )
            memory = replace(memory, swing=swing)
        body = advance_body(
            body,
            self._body_target(memory),
            self._rates,
            seen.dt,
            seen.terms.q,
            seen.user_held,
        )
        command = self._balance.command(
            seen,
            body,
            memory.dcm_reference(),
            memory.omega,
            memory.support,
            self._feet(memory, seen, swing_reference),
        )
        finished = self._at_rest(memory, seen)
        if finished and memory.pending:
            left = ", ".join(str(step.index) for step in memory.pending)
            text = f"WALK ends without the steps {left}"
            if memory.obstacle:
                text += f": {memory.obstacle}"
            events = (*events, Event(seen.time, STEPS_LEFT, text))
        elif finished and memory.current is None and not leaving:
            text = "WALK ends without a step: walk_params.step_queue has none"
            events = (*events, Event(seen.time, STEPS_LEFT, text))
        return Outcome(
            memory=memory,
            body=body,
            command=command,
            finished=finished,
            status_flags=self._flags(memory, leaving),
            events=events,
        )

    def plan(self, memory: WalkMemory, com: np.ndarray, omega: float) -> Plan:
        """DCM plan, footsteps to come and the swing at hand."""
        return walk_plan(memory, com, self._profile)

    def report(self, memory: WalkMemory, state: AtlasSimInterfaceState) -> None:
        """Steps and timing; the steps as they will really be taken."""
        feedback = state.walk_feedback
        coming = self._coming(memory)
        feedback.t_step_rem = time_to_touchdown(memory, coming, self._timing)
        feedback.current_step_index = memory.current.index if memory.current else 0
        known = memory.known
        feedback.next_step_index_needed = memory.next_index + len(known)
        for place, step in enumerate(coming[:LOOK_AHEAD]):
            feedback.step_queue_saturated[place] = step_data_from(step)

    # ---- steps ---------------------------------------------------------------

    def _read_queue(
        self, memory: WalkMemory, request: AtlasSimInterfaceCommand
    ) -> WalkMemory:
        params, seen = request.walk_params, memory.seen_params
        if params is seen:
            return memory
        memory = replace(memory, seen_params=params)
        if params.use_demo_walk and seen.use_demo_walk:
            return memory
        pending = steps_asked_for(
            () if seen.use_demo_walk else memory.pending,
            params,
            feet_to_come(memory),
            memory.next_index,
            self._gait,
            memory.last_foot,
        )
        # A step that was sent anew is another one, which nothing was told of yet.
        new = replaced(memory.pending, pending)
        told = frozenset(about for about in memory.told if about[0] not in new)
        return replace(memory, pending=pending, told=told)

    def _look_ahead(self, memory: WalkMemory) -> Outlook:
        return look_ahead(memory, self._limits, self._slack)

    def _coming(self, memory: WalkMemory) -> tuple[Footstep, ...]:
        return self._look_ahead(memory).steps

    def _tell(
        self, memory: WalkMemory, time: float
    ) -> tuple[WalkMemory, tuple[Event, ...]]:
        """Warns once of each step that is not taken as sent, when that is known."""
        news = warnings_about(self._look_ahead(memory), memory.told, time)
        told = memory.told.union(map(subject, news))
        return replace(memory, told=told), news

    def _leave(self, memory: WalkMemory) -> WalkMemory:
        """Drops what has not begun: a foot in the air lands, then both catch."""
        memory = replace(memory, pending=())
        if memory.phase in (Phase.SHIFT, Phase.TRANSFER):
            return self._settle(memory)
        return memory

    def _replan(
        self, memory: WalkMemory, cop: np.ndarray, first_phase: float
    ) -> WalkMemory:
        coming = self._coming(memory)
        swinging = memory.swinging
        plan = plan_walk(
            cop,
            first_phase,
            memory.feet,
            coming,
            swinging,
            self._timing,
            memory.omega,
        )
        unloading = coming[0].foot if coming and not swinging else None
        return replace(memory, plan=plan, plan_time=0.0, unloading=unloading)

    # ---- phases --------------------------------------------------------------

    def _change_phase(
        self, memory: WalkMemory, seen: Observation
    ) -> tuple[WalkMemory, tuple[Event, ...]]:
        if memory.swinging:
            touched = (
                memory.swing_in_progress.progress >= self._rules.earliest_touchdown
                and seen.foot_force[memory.step.foot] > self._touchdown_force
            )
            return self._touch_down(memory, seen) if touched else (memory, ())
        if memory.phase is Phase.SETTLE:
            more = not memory.obstacle and self._coming(memory)
            return (self._shift(memory) if more else memory), ()
        if memory.elapsed < memory.duration:
            return memory, ()
        if not self._coming(memory):
            return self._settle(memory), ()
        late = memory.elapsed - memory.duration
        patient = late < self._rules.longest_wait and not self._straight(memory, seen)
        if patient and not self._ready(memory, seen):
            # Hold the plan at the moment of lift-off until the DCM is there.
            return replace(memory, plan_time=memory.plan_time - seen.dt), ()
        # Since touchdown the soles have come to lie flat under their load.
        memory = replace(memory, feet=(seen.foot_pose(0), seen.foot_pose(1)))
        memory, news = self._tell(memory, seen.time)
        if not self._coming(memory):
            # From where they are now the step cannot be taken.
            return self._settle(memory), news
        return self._lift_off(memory, seen), news

    def _ready(self, memory: WalkMemory, seen: Observation) -> bool:
        """Whether the DCM is near enough to its plan for single support."""
        error = feedback.dcm(seen.terms, memory.omega) - (
            memory.plan.evaluate(memory.plan_time).dcm
        )
        return float(np.hypot(*error)) < self._rules.dcm_ready

    def _straight(self, memory: WalkMemory, seen: Observation) -> bool:
        """Whether the leg that is to leave is at its full length.

        Planted, it holds the pelvis back, so that no waiting brings the DCM nearer.
        """
        foot = memory.unloading
        return foot is not None and (
            float(seen.terms.q[self._knees[foot]]) < self._straight_knees[foot]
        )

    def _lift_off(self, memory: WalkMemory, seen: Observation) -> WalkMemory:
        step = self._coming(memory)[0]
        stance = 1 - step.foot
        sent = next(s for s in memory.pending if s.index == step.index)
        # A tick that the transfer was too long is taken off the swing.
        late = min(max(memory.elapsed - memory.duration, 0.0), seen.dt)
        duration = self._timing.swing(step.duration) - late
        memory = replace(
            memory,
            phase=Phase.SWING,
            elapsed=0.0,
            duration=duration,
            pending=tuple(s for s in memory.pending if s.index > step.index),
            current=step,
            commanded=sent,
            swing=begin_swing(memory.feet[step.foot], duration),
            support=self._balance.support(memory.feet[stance]),
            next_index=step.index + 1,
        )
        cop = stance_cop(memory.feet[stance], stance)
        memory = self._replan(memory, cop, duration)
        coming = self._coming(memory)
        sensitivity = landing_sensitivity(
            cop, duration, memory.feet, coming, self._timing, memory.omega
        )
        return replace(memory, sensitivity=sensitivity)

    def _touch_down(
        self, memory: WalkMemory, seen: Observation
    ) -> tuple[WalkMemory, tuple[Event, ...]]:
        step, sent = memory.step, memory.sent
        early = memory.duration - memory.elapsed
        landed = seen.foot_pose(step.foot)
        feet, aimed = list(memory.feet), list(memory.aimed)
        feet[step.foot], aimed[step.foot] = landed, step.pose
        cop = memory.plan.evaluate(memory.plan_time).cop
        memory = replace(
            memory,
            phase=Phase.TRANSFER,
            elapsed=0.0,
            feet=(feet[0], feet[1]),
            aimed=(aimed[0], aimed[1]),
            swing=None,
            support=self._balance.support(*feet),
        )
        coming = self._coming(memory)
        event = footstep_event(seen.time, sent, step, landed)
        if not coming:
            return self._settle(memory, cop), (event,)
        # The next touchdown is due a step's duration after this one was.
        transfer = self._timing.transfer(coming[0].duration)
        change = self._rules.transfer_change * transfer
        transfer += min(max(early, -change), change)
        memory = replace(memory, duration=transfer)
        return self._replan(memory, cop, memory.duration), (event,)

    def _shift(self, memory: WalkMemory) -> WalkMemory:
        """Sets off once more: steps came while the robot was catching."""
        now = memory.plan.evaluate(memory.plan_time)
        memory = replace(
            memory, phase=Phase.SHIFT, elapsed=0.0, duration=self._timing.first_shift
        )
        memory = self._replan(memory, now.cop, memory.duration)
        return replace(memory, plan=begun_at(memory.plan, now.dcm, memory.support))

    def _settle(self, memory: WalkMemory, cop: np.ndarray | None = None) -> WalkMemory:
        if cop is None:
            cop = memory.plan.evaluate(memory.plan_time).cop
        memory = replace(
            memory,
            phase=Phase.SETTLE,
            elapsed=0.0,
            duration=self._timing.settle,
            support=self._balance.support(*memory.feet),
            obstacle=self._look_ahead(memory).obstacle,
        )
        return self._replan(memory, cop, memory.duration)

    def _at_rest(self, memory: WalkMemory, seen: Observation) -> bool:
        return (
            memory.phase is Phase.SETTLE
            and memory.elapsed > memory.duration + self._timing.rest
            and float(np.abs(seen.terms.com_velocity).max()) < self._rules.rest_speed
        )

    # ---- balance -------------------------------------------------------------

    def _adjust_step(self, memory: WalkMemory, seen: Observation) -> WalkMemory:
        """Moves the landing place when the ankles cannot hold the DCM."""
        remaining = memory.duration - memory.elapsed
        if remaining < self._rules.frozen_end:
            return memory
        step = memory.step
        stance = memory.feet[1 - step.foot]
        error = feedback.dcm(seen.terms, memory.omega) - (
            memory.plan.evaluate(memory.plan_time).dcm
        )
        shift = step_shift(
            error,
            remaining,
            memory.omega,
            memory.sensitivity,
            stance,
            self._adjustment,
        )
        if float(np.abs(shift).max()) < self._rules.replan_shift:
            return memory
        moved = saturate(
            replace(step, p_WF=step.p_WF + np.append(shift, 0.0)),
            stance,
            self._loose_limits,
        )
        memory = replace(memory, current=moved)
        plan_time = memory.plan_time
        cop = stance_cop(stance, 1 - step.foot)
        memory = self._replan(memory, cop, memory.duration)
        return replace(memory, plan_time=plan_time)

    def _body_target(self, memory: WalkMemory) -> BodyTarget:
        left, right = feet_to_come(memory)
        low, high = sorted([float(left.p_WF[2]), float(right.p_WF[2])])
        # With one foot above the other, or on its way there, the upper leg bends no
        # more than the lower one's reach makes it: bent knees carry least.
        ground = min(high, low + self._rules.leg_stretch)
        return BodyTarget(
            height=ground + self._nominal_height,
            yaw=mean_yaw(left.yaw, right.yaw),
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=_UPRIGHT,
        )

    def _feet(
        self,
        memory: WalkMemory,
        seen: Observation,
        swing_reference: SwingReference | None,
    ) -> tuple[FootCommand, FootCommand]:
        balance = self._balance
        if swing_reference is not None:
            foot = memory.step.foot
            stance = balance.planted(seen, 1 - foot)
            swing = balance.swinging(seen, foot, swing_reference)
            return (swing, stance) if foot == LEFT else (stance, swing)
        loads = [FULL_LOAD, FULL_LOAD]
        if memory.unloading is not None and not memory.waiting:
            left_share = 1.0 - memory.elapsed / memory.duration
            unload = min(max(left_share / self._rules.unload_share, 0.01), 1.0)
            loads[memory.unloading] = unload
        return (balance.planted(seen, 0, loads[0]), balance.planted(seen, 1, loads[1]))

    def _flags(self, memory: WalkMemory, leaving: bool) -> int:
        flags = AtlasBehaviorWalkFeedback
        if memory.phase is Phase.SHIFT:
            return flags.WALK_SUBSTATE_SWAYING
        if memory.phase is Phase.SETTLE:
            if memory.obstacle:
                why = flags.WALK_ERROR_INCONSISTENT_STEPS
            elif leaving:
                why = flags.WALK_OKAY
            else:
                why = flags.WALK_WARNING_INSUFFICIENT_STEP_DATA
            return flags.WALK_SUBSTATE_CATCHING | why
        return flags.WALK_SUBSTATE_STEPPING
