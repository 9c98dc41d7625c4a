"""REST, SHIFT and SETTLE: both feet are down, and steps begin and end.

Computes each tick of these phases, and plans the weight shifts, each of which starts at
the present DCM.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import footstep_event, out_of_reach, pace_changed
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.behaviors.step.action import demo_step, desired_step
from atlas_drake.behaviors.step.phases import (
    Rest,
    StepPhase,
    StepProgress,
    StepSettle,
    StepShift,
    StepState,
    StepSwing,
)
from atlas_drake.behaviors.step.plan import StepPlan
from atlas_drake.behaviors.step.step_balance import (
    Reach,
    StepBalance,
    StepPhaseControl,
)
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import resolve_height
from atlas_drake.control.feet.leg_kinematics import hips_from_com
from atlas_drake.control.feet.sole import on_toes, toe_off_reference
from atlas_drake.control.feet.step_swing import StepSwingProfile, plan_step_swing
from atlas_drake.frozen import replace
from atlas_drake.messages import ToeOff
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.planning.footholds import Gait


class StepBeginning:
    """Makes the phases ``Rest`` and ``StepShift``. Holds constants only."""

    def __init__(
        self,
        balance: StepBalance,
        default: StepAction,
        profile: StepSwingProfile,
        gait: Gait,
    ):
        self._balance = balance
        self._planner = balance.planner
        self._rules = balance.rules
        self._default = default
        self._profile = profile
        self._gait = gait
        self._limits = balance.planner.limits

    def enter(self, observation: Observation) -> Rest:
        """Makes the rest with which STEP begins."""
        feet = observation.foot_poses
        return self._rest_on(feet, observation, StepProgress())

    def rest(
        self,
        phase: StepShift | StepSettle,
        observation: Observation,
        feet: tuple[FootPose, FootPose],
    ) -> Rest:
        """Makes the rest after a step: the weight shifts to between ``feet``."""
        uneven = abs(float(feet[0].p_WF[2] - feet[1].p_WF[2]))
        return replace(
            self._rest_on(feet, observation, phase.progress),
            last=phase.step,
            touchdown_foot=phase.step.foot,
            lean=phase.lean if uneven > self._rules.level else 0.0,
        )

    def begin(
        self, phase: Rest, observation: Observation, leaving: bool
    ) -> tuple[Rest | StepShift, tuple[Event, ...]]:
        """Plans the whole step and begins the weight shift to the stance foot.

        The robot stays at rest without a requested step, while its DCM is too near the
        edge of the support polygon, and for a step that is out of reach.
        """
        desired = None if leaving else self.requested(phase)
        if desired is None:
            return phase, ()
        outside = self._balance.dcm_outside(phase, observation, phase.support)
        if outside > -self._rules.begin_inside:
            return phase, ()
        feet = observation.foot_poses
        plan = self._planner.plan(observation.terms, feet, desired)
        if plan is None:
            text = f"step {desired.index} is not taken: it is out of reach"
            progress = replace(phase.progress, refused=phase.progress.request)
            event = Event(observation.time, STEPS_LEFT, text)
            return replace(phase, progress=progress), (event,)
        step = plan.taken
        # Warn of the slope only: the step spec in the report has duration and swing
        # height.
        slope = replace(
            resolve_height(desired, feet[1 - step.foot], self._limits),
            duration=step.duration,
            swing_height=step.swing_height,
        )
        return self._shift(phase, observation, desired, plan, feet), (
            *out_of_reach(observation.time, desired, step),
            *pace_changed(observation.time, slope, step),
        )

    def requested(self, phase: StepPhase) -> Footstep | None:
        """Returns the requested step that has not begun, if any."""
        progress = phase.progress
        request = progress.request
        if request is None or not request.is_newer(progress.refused):
            return None
        params = request.command.step_params
        if params.use_demo_walk:
            index = progress.index + 1
            desired = demo_step(phase.feet, index, self._default, self._gait)
        else:
            feet_z = (float(phase.feet[0].p_WF[2]), float(phase.feet[1].p_WF[2]))
            desired = desired_step(params, feet_z, self._default)
        if desired is None or desired.index <= progress.index:
            return None
        return desired

    def _rest_on(
        self,
        feet: tuple[FootPose, FootPose],
        observation: Observation,
        progress: StepProgress,
    ) -> Rest:
        balance = self._balance
        middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
        support = balance.balance.support(*feet)
        return Rest(
            progress=progress,
            feet=feet,
            support=support,
            hips=hips_from_com(observation.terms, self._planner.legs),
            shift=balance.shift_to(observation, middle, self._default, feet, support),
        )

    def _shift(
        self,
        phase: Rest,
        observation: Observation,
        desired: Footstep,
        plan: StepPlan,
        feet: tuple[FootPose, FootPose],
    ) -> StepShift:
        balance, step = self._balance, plan.taken
        start, goal = feet[step.foot], step.pose
        least = self._rules.least_clearance
        action = _below(plan.ceiling, step.action, start, goal, least)
        swing = plan_step_swing(
            on_toes(start, plan.heel, self._planner.half_length),
            start,
            goal,
            action.lift_height,
            action.swing_height,
            action.step_duration,
            action.max_foot_vel,
            self._profile,
        )
        support = balance.balance.support(*feet)
        shift = balance.shift_to(observation, plan.com, action, feet, support)
        middle_z = 0.5 * (start.p_WF[2] + step.p_WF[2])
        action = replace(
            action,
            step_duration=swing.duration,
            sway_duration=shift.duration,
            toe_off=ToeOff.ENABLE if plan.heel else ToeOff.DISABLE,
        )
        return StepShift(
            progress=replace(phase.progress, index=step.index),
            feet=feet,
            support=support,
            hips=plan.hips,
            shift=shift,
            lean=plan.lean,
            sent=desired,
            step=replace(
                step,
                duration=swing.duration,
                swing_height=float(swing.top + swing.arc - middle_z),
                action=action,
            ),
            swing=swing,
            heel=plan.heel,
            touchdown_foot=phase.touchdown_foot if balance.is_early(phase) else None,
        )


def _below(
    ceiling: float, action: StepAction, start: FootPose, goal: FootPose, least: float
) -> StepAction:
    """Limits the action so that the foot is lifted no higher than ``ceiling`` [m].

    The foot is lifted by at least ``least`` [m] above the footholds in any case.
    """
    room = max(ceiling - float(max(start.p_WF[2], goal.p_WF[2])), least)
    lift = min(action.lift_height, room)
    arc = min(action.swing_height, room - lift)
    return replace(action, lift_height=lift, swing_height=arc)


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
        if phase.touchdown_foot is None or not balance.is_early(phase):
            return phase, balance.balance.standing(observation)
        cop = self.cop(phase, observation)
        return phase, balance.touchdown(phase, observation, phase.touchdown_foot, cop)


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
        landed = phase.touchdown_foot
        if landed is not None and balance.is_early(phase):
            return phase, balance.touchdown(phase, observation, landed, cop, on_toes)
        rest = 1.0 - phase.elapsed / phase.shift.duration
        load = max(rest / self._rules.unload_share, 0.01)
        load = max(load, balance.load_range(phase, foot, cop, on_toes)[0])
        if not on_toes:
            command = balance.balance.in_contact(observation, foot, load)
            return phase, balance.with_stance(observation, foot, command)
        reference = toe_off_reference(
            phase.feet[foot], angle, rate, acceleration, self._half_length
        )
        command = balance.balance.toeing_off(observation, foot, reference, load)
        return phase, balance.with_stance(observation, foot, command)

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
        return phase, self._balance.touchdown(phase, observation, foot, cop)
