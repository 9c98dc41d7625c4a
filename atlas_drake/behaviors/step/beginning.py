"""The weight shifts with which a step of STEP begins, and ends at rest.

Each shift starts at the present DCM. ``both_feet`` determines when a step begins or
ends.
"""

from __future__ import annotations

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import out_of_reach, pace_changed
from atlas_drake.behaviors.step.action import demo_step, desired_step
from atlas_drake.behaviors.step.phases import (
    Rest,
    StepPhase,
    StepProgress,
    StepSettle,
    StepShift,
)
from atlas_drake.behaviors.step.plan import StepPlan
from atlas_drake.behaviors.step.step_balance import StepBalance
from atlas_drake.control.feet.footstep import resolve_height
from atlas_drake.control.feet.leg_kinematics import hips_from_com
from atlas_drake.control.feet.sole import on_toes
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
            fresh=phase.step.foot,
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
            fresh=phase.fresh if balance.is_fresh(phase) else None,
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
