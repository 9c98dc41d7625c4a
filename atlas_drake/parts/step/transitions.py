"""What follows what in STEP: the one place that makes phases."""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.footsteps import (
    contact_event,
    footstep_event,
    out_of_reach,
    pace_changed,
)
from atlas_drake.behaviors.phases import with_foot
from atlas_drake.control.feet.footstep import resolve_height
from atlas_drake.control.feet.leg_kinematics import hips_from_com
from atlas_drake.control.feet.sole_motion import pitched_pose
from atlas_drake.frozen import replace
from atlas_drake.messages import ToeOff
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.parts.step.phase import Decision, StepPhase, StepProgress
from atlas_drake.parts.step.plan import StepPlan
from atlas_drake.parts.step.rest import Rest
from atlas_drake.parts.step.settle import Settle
from atlas_drake.parts.step.shift import Shift
from atlas_drake.parts.step.swing import Swing
from atlas_drake.parts.step.swing_path import SwingPath, plan_swing_path
from atlas_drake.parts.step.tools import StepTick
from atlas_drake.parts.step.weight_shift import WeightShift

Events = tuple[Event, ...]


def next_phase(
    phase: StepPhase, decision: Decision, tick: StepTick
) -> tuple[StepPhase, Events]:
    """Returns the phase that a decision leads to, and what the log is told of it."""
    match phase, decision:
        case Rest(), Decision.BEGIN:
            return begin(phase, tick)
        case Shift(), Decision.LIFT_OFF:
            return lift_off(phase, tick), ()
        case Shift(), Decision.GIVE_UP:
            return give_up(phase, tick)
        case Swing(), Decision.LOWER:
            return lower(phase, tick), ()
        case Swing(), Decision.LAND:
            return land(phase, tick)
        case Swing(), Decision.GO_BACK:
            return go_back(phase, tick)
        case Settle(), Decision.REST:
            return end_step(phase, tick)
    return phase, ()


# ---- both feet are down ------------------------------------------------------


def first_rest(tick: StepTick) -> Rest:
    """Makes the rest with which STEP begins."""
    return _rest_on(tick.observation.foot_poses, StepProgress(), tick)


def begin(phase: Rest, tick: StepTick) -> tuple[Rest | Shift, Events]:
    """Plans the requested step, and begins the weight shift to the stance foot.

    The robot stays at rest before a step that is out of reach.
    """
    observation, planner = tick.observation, tick.tools.planner
    desired, feet = phase.requested(tick), observation.foot_poses
    if desired is None:
        return phase, ()
    plan = planner.plan(observation.terms, feet, desired)
    if plan is None:
        text = f"step {desired.index} is not taken: it is out of reach"
        progress = replace(phase.progress, done=phase.progress.request)
        event = Event(observation.time, STEPS_LEFT, text)
        return replace(phase, progress=progress), (event,)
    step = plan.taken
    # Warn of the slope only: the step spec in the report has duration and swing height.
    slope = replace(
        resolve_height(desired, feet[1 - step.foot], planner.limits),
        duration=step.duration,
        swing_height=step.swing_height,
    )
    return _shift(phase, desired, plan, feet, tick), (
        *out_of_reach(observation.time, desired, step),
        *pace_changed(observation.time, slope, step),
    )


def give_up(phase: Shift, tick: StepTick) -> tuple[Rest, Events]:
    """Abandons a step: the weight shifts back to between the feet."""
    text = f"step {phase.progress.index} is not taken: its foot cannot be unloaded"
    rest = _rest_after(phase, phase.feet, tick)
    event = Event(tick.observation.time, STEPS_LEFT, text)
    return replace(rest, gave_up=True), (event,)


def end_step(phase: Settle, tick: StepTick) -> tuple[StepPhase, Events]:
    """Ends the step, and begins the next step if one is requested."""
    step, landed = phase.step, tick.observation.foot_pose(phase.step.foot)
    rest = _rest_after(phase, with_foot(phase.feet, step.foot, landed), tick)
    following, events = next_phase(rest, rest.decide(tick), tick)
    if phase.went_back:
        return following, events
    landing = footstep_event(tick.observation.time, phase.sent, step, landed)
    return following, (landing, *events)


def _rest_after(
    phase: Shift | Settle, feet: tuple[FootPose, FootPose], tick: StepTick
) -> Rest:
    """Makes the rest after a step: the weight shifts to between ``feet``."""
    uneven = abs(float(feet[0].p_WF[2] - feet[1].p_WF[2]))
    return replace(
        _rest_on(feet, phase.progress, tick),
        last=phase.step,
        touchdown_foot=phase.step.foot,
        lean=phase.lean if uneven > tick.rules.level else 0.0,
    )


def _rest_on(
    feet: tuple[FootPose, FootPose], progress: StepProgress, tick: StepTick
) -> Rest:
    tools = tick.tools
    middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
    support = tools.balance.support(*feet)
    return Rest(
        progress=progress,
        feet=feet,
        support=support,
        hips=_hips(tick),
        shift=tick.shift_to(middle, tools.usual_action, feet, support),
    )


def _shift(
    phase: Rest,
    desired: Footstep,
    plan: StepPlan,
    feet: tuple[FootPose, FootPose],
    tick: StepTick,
) -> Shift:
    """Makes the weight shift of a planned step."""
    step = plan.taken
    start, goal = feet[step.foot], step.pose
    action = _below(plan.ceiling, step.action, start, goal, tick.rules.least_clearance)
    toeing = pitched_pose(start, plan.heel, tick.half_length)
    path = _path(toeing, start, goal, action, tick)
    support = tick.tools.balance.support(*feet)
    shift = tick.shift_to(plan.com, action, feet, support)
    middle_z = 0.5 * (start.p_WF[2] + step.p_WF[2])
    progress = replace(phase.progress, index=step.index)
    request = progress.request
    if request is not None and not request.command.step_params.use_demo_walk:
        progress = replace(progress, done=request)
    return Shift(
        progress=progress,
        feet=feet,
        support=support,
        hips=plan.hips,
        shift=shift,
        lean=plan.lean,
        sent=desired,
        step=replace(
            step,
            duration=path.duration,
            swing_height=float(path.top + path.arc - middle_z),
            action=replace(
                action,
                step_duration=path.duration,
                sway_duration=shift.duration,
                toe_off=ToeOff.ENABLE if plan.heel else ToeOff.DISABLE,
            ),
        ),
        path=path,
        heel=plan.heel,
        touchdown_foot=phase.touchdown_foot if phase.is_early(tick) else None,
    )


# ---- a foot is in the air ----------------------------------------------------


def lift_off(phase: Shift, tick: StepTick) -> Swing:
    """Makes the swing on the stance foot alone."""
    return Swing(
        progress=phase.progress,
        feet=phase.feet,
        support=tick.tools.balance.support(phase.feet[phase.stance]),
        hips=_hips(tick),
        shift=phase.shift,
        shift_time=phase.shift_time,
        lean=phase.lean,
        sent=phase.sent,
        step=phase.step,
        path=phase.path,
    )


def lower(phase: Swing, tick: StepTick) -> Swing:
    """Leans into the step by the requested distance while the foot comes down.

    The distance is limited so that the standing foot can still bring the body back if
    the other foot finds no ground.
    """
    lowering, step, support = replace(phase, lowers=True), phase.step, phase.support
    distance = step.action.step_end_dist
    if distance == 0.0:
        return lowering
    over, stance = phase.shift.end, phase.feet[phase.stance]
    way = step.p_WF[:2] - stance.p_WF[:2]
    lean = distance * way / np.hypot(*way)
    omega, rules = tick.omega((stance,)), tick.rules
    for share in np.linspace(1.0, 0.0, 11):
        shift = WeightShift(over, over + share * lean, phase.path.lower)
        inside = -support.distance_outside(shift.end)
        # The CoP of the motion must lie within the standing sole, too.
        pushed = -shift.cop_outside(support, omega)
        if inside >= rules.lean_inside and pushed >= rules.cop_inside:
            break
    return replace(lowering, shift=shift, shift_time=0.0)


def go_back(phase: Swing, tick: StepTick) -> tuple[Swing, Events]:
    """Returns the foot to its lift-off pose, where ground is known."""
    step, action = phase.step, phase.step.action
    home, here = phase.feet[step.foot], tick.observation.foot_pose(step.foot)
    path = _path(here, here, home, action, tick)
    normal = home.R_WF[:, 2].copy()
    back = replace(
        phase,
        elapsed=0.0,
        step=replace(step, p_WF=home.p_WF, yaw=home.yaw, normal=normal),
        path=path,
        lowers=False,
        went_back=True,
    )
    if action.step_end_dist != 0.0:
        # Bring the body back over the standing foot, from which it leant.
        over, stance = phase.shift.start, (phase.feet[phase.stance],)
        quick = replace(action, sway_duration=path.lower)
        shift = tick.shift_to(over, quick, stance, phase.support)
        upright = replace(back.step, action=replace(action, step_end_dist=0.0))
        back = replace(back, step=upright, shift=shift, shift_time=0.0)
    text = f"step {step.index} found no ground; its foot returns"
    return back, (Event(tick.observation.time, STEPS_LEFT, text),)


def land(phase: Swing, tick: StepTick) -> tuple[Settle, Events]:
    """Presses the foot flat, because perhaps only an edge touched the ground."""
    observation, foot = tick.observation, phase.step.foot
    feet = with_foot(phase.feet, foot, observation.foot_pose(foot))
    settle = Settle(
        progress=phase.progress,
        feet=feet,
        support=tick.tools.balance.support(*feet),
        hips=phase.hips,
        shift=phase.shift,
        shift_time=phase.shift_time,
        lean=phase.lean,
        sent=phase.sent,
        step=phase.step,
        path=phase.path,
        went_back=phase.went_back,
    )
    early = phase.path.duration - phase.elapsed
    return settle, contact_event(observation.time, phase.step, early)


def _path(
    start: FootPose, home: FootPose, goal: FootPose, action: StepAction, tick: StepTick
) -> SwingPath:
    return plan_swing_path(
        start,
        home,
        goal,
        action.lift_height,
        action.swing_height,
        action.step_duration,
        action.max_foot_vel,
        tick.tools.config.swing,
    )


def _hips(tick: StepTick) -> np.ndarray:
    return hips_from_com(tick.observation.terms, tick.tools.planner.legs)


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
