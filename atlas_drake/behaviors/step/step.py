"""STEP: one quasi-static step at a time, in any order of the feet.

Phases: SWAY (weight over the foot that stays), SWING (lift and move), LOWER, SETTLE
(the new foot is pressed flat) and REST (weight back between the feet) until the next
step is asked for. In single support the center of mass stands still over the sole;
nothing here depends on momentum.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, advance_body
from atlas_drake.behaviors.footstep_event import (
    footstep_event,
    out_of_reach,
    pace_changed,
)
from atlas_drake.behaviors.step.action import (
    DesiredStep,
    StepAction,
    demo_step,
    desired_step,
    step_spec_from,
)
from atlas_drake.behaviors.step.balance import StepBalance
from atlas_drake.behaviors.step.config import StepConfig
from atlas_drake.behaviors.step.memory import StepMemory, StepPhase
from atlas_drake.behaviors.step.plan import StepPlanner
from atlas_drake.behaviors.step.preview import step_plan
from atlas_drake.behaviors.step.queue import step_data_from
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.balance.weight_shift import (
    WeightShift,
    plan_weight_shift,
    sway_duration,
)
from atlas_drake.control.feet.footstep import FootPose, resolve_height
from atlas_drake.control.feet.leg_reach import hips_from_com
from atlas_drake.control.feet.step_swing import plan_step_swing
from atlas_drake.control.feet.toe_off import on_toes
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    NO_STEP,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    StepStatus,
    ToeOff,
)
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.planning.footholds import Gait


class Step:
    """Takes one step after the other when it is told to."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        config: StepConfig | None = None,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        self._balance = balance
        self._nominal_height = nominal_height
        config = config or StepConfig()
        self._rates = config.body
        self._profile = config.swing
        self._rules = config.rules
        self._limits = balance.robot.file.step_limits
        self._planner = StepPlanner(balance, nominal_height, config.posture)
        self._stance = StepBalance(balance, nominal_height, self._planner, self._rules)
        self._legs = self._planner.legs
        self._gait = Gait.of(balance.robot)
        self._default = StepAction(knee_nominal=self._planner.nominal_knee)

    def enter(
        self,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
    ) -> StepMemory:
        """Rests on both feet; the first step begins at the first tick."""
        feet = (seen.foot_pose(0), seen.foot_pose(1))
        support = self._balance.support(*feet)
        middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
        return StepMemory(
            phase=StepPhase.REST,
            elapsed=0.0,
            feet=feet,
            support=support,
            hips=hips_from_com(seen.terms, self._legs),
            sway=self._sway_to(seen, middle, self._default, feet, support),
            sway_time=0.0,
        )

    def update(
        self,
        memory: StepMemory,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
        leaving: bool,
    ) -> Outcome:
        """One tick; ``leaving`` puts the foot in the air down and begins no step."""
        memory = replace(
            memory,
            elapsed=memory.elapsed + seen.dt,
            sway_time=memory.sway_time + seen.dt,
            leaving=leaving
            and (memory.leaving or memory.in_air or self._stance.heel(memory)[0] > 0.0),
        )
        memory, events = self._look_at(memory, seen, request)
        wanted = None if leaving else self._next(memory, request)
        memory, landing = self._change_phase(memory, seen, wanted)
        body = advance_body(
            body,
            self._stance.body_target(memory),
            self._rates,
            seen.dt,
            seen.terms.q,
            seen.user_held,
        )
        finished = leaving and self._may_stand(memory, seen)
        left = self._left_by_standing(memory, seen, request) if finished else ()
        return Outcome(
            memory=memory,
            body=body,
            command=self._stance.command(memory, seen, body),
            finished=finished,
            status_flags=StepStatus.SUBSTATE_STEPPING
            if memory.in_air
            else StepStatus.SUBSTATE_SWAYING,
            events=(*events, *landing, *left),
        )

    def plan(self, memory: StepMemory, com: np.ndarray, omega: float) -> Plan:
        """The weight shift or the swing at hand."""
        return step_plan(memory, omega)

    def report(self, memory: StepMemory, state: AtlasSimInterfaceState) -> None:
        """Indices and timing; the step as it is really taken."""
        feedback = state.step_feedback
        feedback.current_step_index = memory.index
        feedback.next_step_index_needed = memory.index + 1
        if memory.taken is None:
            return
        feedback.t_step_rem = self._time_left(memory)
        feedback.desired_step_saturated = step_data_from(memory.step)
        feedback.desired_step_spec_saturated = step_spec_from(memory.step, memory.how)

    def _time_left(self, memory: StepMemory) -> float:
        """Until both feet carry again, if the ground is where it is thought to be [s].

        It does not grow when something takes longer than planned.
        """
        if memory.phase is StepPhase.REST:
            return 0.0
        settle, swing = self._rules.settle, memory.planned_swing.duration
        if memory.phase is StepPhase.SETTLE:
            return max(settle - memory.elapsed, 0.0)
        if memory.phase is StepPhase.SWAY:
            return max(memory.sway.duration - memory.elapsed, 0.0) + swing + settle
        return max(swing - memory.elapsed, 0.0) + settle

    # ---- steps ---------------------------------------------------------------

    def _next(
        self, memory: StepMemory, request: AtlasSimInterfaceCommand
    ) -> DesiredStep | None:
        """The step in force that has not begun, if any."""
        params = request.step_params
        if params.use_demo_walk:
            wanted = demo_step(memory.feet, memory.index + 1, self._default, self._gait)
        else:
            feet_z = (float(memory.feet[0].p_WF[2]), float(memory.feet[1].p_WF[2]))
            wanted = desired_step(params, feet_z, self._default)
        if wanted is None or wanted.step.index <= memory.index:
            return None
        return None if memory.refused is params else wanted

    def _look_at(
        self, memory: StepMemory, seen: Observation, request: AtlasSimInterfaceCommand
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        """Warns of a new message whose step comes too late to be taken."""
        params = request.step_params
        if params is memory.looked_at:
            return memory, ()
        before, memory = memory.looked_at, replace(memory, looked_at=params)
        if params.use_demo_walk:
            return memory, ()
        step = params.desired_step_spec if params.use_spec else params.desired_step
        if step.step_index == NO_STEP or step.step_index > memory.index:
            return memory, ()
        if params == before:
            return memory, ()
        text = (
            f"step {step.step_index} is not taken: the next one is {memory.index + 1}"
        )
        return memory, (Event(seen.time, "warning", text),)

    def _begin(
        self,
        memory: StepMemory,
        seen: Observation,
        wanted: DesiredStep | None,
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        """Plans the whole step and begins to sway over the foot that stays."""
        if wanted is None:
            return memory, ()
        if self._dcm_outside(memory, seen) > -self._rules.begin_inside:
            return memory, ()
        feet = (seen.foot_pose(0), seen.foot_pose(1))
        foot = wanted.step.foot
        plan = self._planner.plan(seen.terms, feet, wanted)
        if plan is None:
            text = f"step {wanted.step.index} is not taken: it is out of reach"
            memory = replace(memory, refused=memory.looked_at)
            return memory, (Event(seen.time, STEPS_LEFT, text),)
        taken = plan.taken
        action = _below(
            plan.ceiling,
            wanted.action,
            feet[foot],
            taken.pose,
            self._rules.least_clearance,
        )
        swing = plan_step_swing(
            on_toes(feet[foot], plan.heel, self._planner.half_length),
            feet[foot],
            taken.pose,
            action.lift_height,
            action.swing_height,
            action.step_duration,
            action.max_foot_vel,
            self._profile,
        )
        support = self._balance.support(*feet)
        sway = self._sway_to(seen, plan.com, action, feet, support)
        middle_z = 0.5 * (feet[foot].p_WF[2] + taken.p_WF[2])
        memory = replace(
            memory,
            fresh=memory.fresh if self._stance.is_fresh(memory) else None,
            phase=StepPhase.SWAY,
            elapsed=0.0,
            feet=feet,
            support=support,
            hips=plan.hips,
            sway=sway,
            sway_time=0.0,
            index=taken.index,
            went_back=False,
            gave_up=False,
            sent=wanted,
            taken=replace(
                taken,
                duration=swing.duration,
                swing_height=float(swing.top + swing.arc - middle_z),
            ),
            action=replace(
                action,
                step_duration=swing.duration,
                sway_duration=sway.duration,
                toe_off=ToeOff.ENABLE if plan.heel else ToeOff.DISABLE,
            ),
            swing=swing,
            heel=plan.heel,
            lean=plan.lean,
        )
        # The slope alone: the step spec in the report has duration and swing height.
        slope = replace(
            resolve_height(wanted.step, feet[1 - foot], self._limits),
            duration=taken.duration,
            swing_height=taken.swing_height,
        )
        return memory, (
            *out_of_reach(seen.time, wanted.step, taken),
            *pace_changed(seen.time, slope, taken),
        )

    # ---- phases --------------------------------------------------------------

    def _change_phase(
        self, memory: StepMemory, seen: Observation, wanted: DesiredStep | None
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        if memory.phase is StepPhase.REST:
            if memory.gave_up and memory.elapsed < memory.sway.duration:
                return memory, ()
            return self._begin(memory, seen, wanted)
        if memory.phase is StepPhase.SWAY:
            if self._ready(memory, seen):
                return self._lift_off(memory, seen), ()
            late = memory.elapsed > memory.sway.duration + self._rules.longest_wait
            if late or self._dcm_outside(memory, seen) > -self._rules.dcm_lost:
                return self._stay(memory, seen)
            return memory, ()
        if memory.phase is StepPhase.SETTLE:
            if memory.elapsed < self._rules.settle:
                return memory, ()
            memory, landing = self._land(memory, seen)
            memory, events = self._begin(memory, seen, wanted)
            return memory, (*landing, *events)
        swing = memory.planned_swing
        if memory.phase is StepPhase.SWING:
            lowering = swing.is_lowering(memory.elapsed)
            return self._begin_to_lower(memory, seen) if lowering else memory, ()
        load = seen.foot_force[memory.step.foot]
        if load > self._rules.touchdown_force * self._balance.weight:
            return self._touch_down(memory, seen), ()
        if swing.has_missed(memory.elapsed):
            return self._step_back(memory, seen)
        return memory, ()

    def _ready(self, memory: StepMemory, seen: Observation) -> bool:
        """Whether the foot may leave the ground: all weight is off it, and at rest."""
        if memory.elapsed < memory.sway.duration:
            return False
        load = seen.foot_force[memory.step.foot]
        if load > self._rules.still_loaded * self._balance.weight:
            return False
        omega = self._stance.omega(seen, (memory.feet[memory.stance],))
        error = feedback.dcm(seen.terms, omega) - memory.sway.end
        return float(np.hypot(*error)) < self._rules.dcm_ready

    def _dcm_outside(self, memory: StepMemory, seen: Observation) -> float:
        """How far the DCM is outside of what the feet can hold [m]; < 0 inside."""
        dcm = feedback.dcm(seen.terms, self._stance.omega(seen, memory.feet))
        return self._stance.support(memory).distance_outside(dcm)

    def _lift_off(self, memory: StepMemory, seen: Observation) -> StepMemory:
        return replace(
            memory,
            phase=StepPhase.SWING,
            elapsed=0.0,
            support=self._balance.support(memory.feet[memory.stance]),
            hips=hips_from_com(seen.terms, self._legs),
        )

    def _begin_to_lower(self, memory: StepMemory, seen: Observation) -> StepMemory:
        """Leans into the step while the foot comes down, as far as it was asked.

        But only as far as the standing foot can undo it: there may be no ground.
        """
        memory = replace(memory, phase=StepPhase.LOWER)
        distance = memory.how.step_end_dist
        if distance == 0.0:
            return memory
        over = memory.sway.end
        way = memory.step.p_WF[:2] - memory.feet[memory.stance].p_WF[:2]
        lean = distance * way / np.hypot(*way)
        omega = self._stance.omega(seen, (memory.feet[memory.stance],))
        support, rules = memory.support, self._rules
        for share in np.linspace(1.0, 0.0, 11):
            sway = WeightShift(over, over + share * lean, memory.planned_swing.lower)
            inside = -support.distance_outside(sway.end)
            # And the foot can push the body there in that time.
            pushed = -sway.cop_outside(support, omega)
            if inside >= rules.lean_inside and pushed >= rules.cop_inside:
                break
        return replace(memory, sway=sway, sway_time=0.0)

    def _touch_down(self, memory: StepMemory, seen: Observation) -> StepMemory:
        """The foot met the ground, perhaps with an edge only: it is pressed flat."""
        feet = _with(memory.feet, memory.step.foot, seen.foot_pose(memory.step.foot))
        return replace(
            memory,
            phase=StepPhase.SETTLE,
            elapsed=0.0,
            feet=feet,
            support=self._balance.support(*feet),
        )

    def _land(
        self, memory: StepMemory, seen: Observation
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        """Both feet are down: the weight goes back between them."""
        step = memory.step
        landed = seen.foot_pose(step.foot)
        feet = _with(memory.feet, step.foot, landed)
        memory = self._rest(memory, seen, feet)
        if memory.went_back:
            return memory, ()
        return memory, (footstep_event(seen.time, memory.wanted.step, step, landed),)

    def _stay(
        self, memory: StepMemory, seen: Observation
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        """Gives up a step whose foot cannot be spared: something pushes the robot."""
        text = f"step {memory.index} is not taken: its foot cannot be spared"
        memory = replace(self._rest(memory, seen, memory.feet), gave_up=True)
        return memory, (Event(seen.time, STEPS_LEFT, text),)

    def _rest(
        self, memory: StepMemory, seen: Observation, feet: tuple[FootPose, FootPose]
    ) -> StepMemory:
        """The weight goes between the feet, the one of this step pressed flat."""
        middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
        uneven = abs(float(feet[0].p_WF[2] - feet[1].p_WF[2]))
        support = self._balance.support(*feet)
        sway = self._sway_to(seen, middle, self._default, feet, support)
        return replace(
            memory,
            phase=StepPhase.REST,
            elapsed=0.0,
            feet=feet,
            support=support,
            hips=hips_from_com(seen.terms, self._legs),
            sway=sway,
            sway_time=0.0,
            heel=0.0,
            fresh=memory.step.foot,
            lean=memory.lean if uneven > self._rules.level else 0.0,
        )

    def _step_back(
        self, memory: StepMemory, seen: Observation
    ) -> tuple[StepMemory, tuple[Event, ...]]:
        """Returns the foot to its lift-off pose, where ground is known."""
        step, action = memory.step, memory.how
        home = memory.feet[step.foot]
        here = seen.foot_pose(step.foot)
        swing = plan_step_swing(
            here,
            here,
            home,
            action.lift_height,
            action.swing_height,
            action.step_duration,
            action.max_foot_vel,
            self._profile,
        )
        normal = home.R_WF[:, 2].copy()
        back = replace(step, p_WF=home.p_WF, yaw=home.yaw, normal=normal)
        text = f"step {step.index} found no ground and goes back"
        memory = replace(
            memory,
            phase=StepPhase.SWING,
            elapsed=0.0,
            taken=back,
            swing=swing,
            went_back=True,
        )
        if action.step_end_dist != 0.0:
            # Over the standing foot again, from which it leant into the step.
            over, stance = memory.sway.start, (memory.feet[memory.stance],)
            quick = replace(action, sway_duration=swing.lower)
            sway = self._sway_to(seen, over, quick, stance, memory.support)
            action = replace(action, step_end_dist=0.0)
            memory = replace(memory, sway=sway, sway_time=0.0, action=action)
        return memory, (Event(seen.time, STEPS_LEFT, text),)

    def _may_stand(self, memory: StepMemory, seen: Observation) -> bool:
        """Whether both feet carry; after a step that was cut short also at rest."""
        if memory.in_air or self._stance.heel(memory)[0] > 0.0:
            return False
        if not memory.leaving:
            return True
        slow = float(np.abs(seen.terms.com_velocity).max()) < self._rules.rest_speed
        return memory.elapsed >= memory.sway.duration and slow

    def _left_by_standing(
        self, memory: StepMemory, seen: Observation, request: AtlasSimInterfaceCommand
    ) -> tuple[Event, ...]:
        """Names the steps that STAND leaves: one that has begun, one still to come."""
        left = [memory.index] if memory.phase is StepPhase.SWAY else []
        wanted = self._next(memory, request)
        if wanted is not None and not request.step_params.use_demo_walk:
            left.append(wanted.step.index)
        if not left:
            return ()
        steps = "step" if len(left) == 1 else "steps"
        text = f"STEP ends without the {steps} {', '.join(map(str, left))}"
        return (Event(seen.time, STEPS_LEFT, text),)

    # ---- sway ----------------------------------------------------------------

    def _sway_to(
        self,
        seen: Observation,
        end: np.ndarray,
        action: StepAction,
        feet: tuple[FootPose, ...],
        support: SupportPolygon,
    ) -> WeightShift:
        """Plans a weight shift to ``end`` from where the robot is and how it moves."""
        omega = self._stance.omega(seen, feet)
        distance = float(np.hypot(*(end - seen.terms.com[:2])))
        least = sway_duration(distance, action.max_body_accel)
        return plan_weight_shift(
            feedback.dcm(seen.terms, omega),
            end,
            max(action.sway_duration, least),
            support,
            self._rules.cop_inside,
            omega,
        )


def _below(
    ceiling: float, action: StepAction, start: FootPose, goal: FootPose, least: float
) -> StepAction:
    """The action with a foot that is lifted no higher than ``ceiling`` in W [m].

    It is lifted ``least`` [m] above the footholds all the same.
    """
    room = max(ceiling - float(max(start.p_WF[2], goal.p_WF[2])), least)
    lift = min(action.lift_height, room)
    arc = min(action.swing_height, room - lift)
    return replace(action, lift_height=lift, swing_height=arc)


def _with(
    feet: tuple[FootPose, FootPose], foot: int, pose: FootPose
) -> tuple[FootPose, FootPose]:
    """The feet with one of them elsewhere."""
    return (pose, feet[1]) if foot == 0 else (feet[0], pose)
