"""What follows what in a walk: the one place that makes phases.

Each phase gets a DCM plan of its own, from the measured poses of the feet.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.footsteps import (
    contact_event,
    footstep_event,
    partial_event,
    recovery_event,
)
from atlas_drake.behaviors.phases import set_down, with_foot
from atlas_drake.behaviors.walk.gait import begun_at, landing_sensitivity, stance_cop
from atlas_drake.behaviors.walk.phase import Decision, WalkPhase, WalkTick
from atlas_drake.behaviors.walk.recovery_steps import (
    is_quiet,
    recovery_step,
    square_up_step,
    step_in_place,
)
from atlas_drake.behaviors.walk.settle import Settle
from atlas_drake.behaviors.walk.steps import WalkProgress, with_warnings
from atlas_drake.behaviors.walk.swing import Swing
from atlas_drake.behaviors.walk.transfer import Transfer
from atlas_drake.control.balance.step_adjustment import (
    SingleSupportState,
    touchdown_for_balance,
)
from atlas_drake.control.feet.footstep import (
    landing_error,
    saturated_heading,
    way_around,
)
from atlas_drake.control.feet.sole_motion import FLAT, Pitch, pitch_from, pitched_pose
from atlas_drake.control.feet.swing_foot import begin_swing, swing_from_the_air
from atlas_drake.frozen import replace
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import Footstep

Events = tuple[Event, ...]
NAMED = 10
"""Number of steps that an event names one by one."""


def next_phase(
    phase: WalkPhase, decision: Decision, tick: WalkTick
) -> tuple[WalkPhase, Events]:
    """Returns the phase that a decision leads to, and what the log is told of it."""
    match phase, decision:
        case Swing(), Decision.STAY:
            return keep_balance(phase, tick), ()
        case _, Decision.STAY:
            return phase, ()
        case Transfer(), Decision.WAIT:
            # The plan stands still at the moment of lift-off.
            return replace(phase, plan_time=phase.plan_time - tick.dt), ()
        case Transfer(), Decision.LIFT_OFF:
            return lift_off(phase, tick)
        case Transfer(), Decision.STEP_AGAIN:
            return step_again(phase, tick)
        case Transfer(), Decision.STOP:
            return make_settle(phase.progress, phase.planned.cop, tick), ()
        case Transfer() | Settle(), Decision.SHIFT_WEIGHT:
            now = phase.planned
            return shift_weight(phase.progress, now.dcm, now.cop, tick), ()
        case Transfer() | Settle(), Decision.CATCH:
            return catch(phase, tick)
        case Swing(), Decision.LAND:
            return land(phase, tick)
        case Settle(), Decision.FINISH:
            return phase, steps_left_out(phase, tick)
    raise AssertionError(f"{phase} decides {decision}")


# ---- a foot lifts off --------------------------------------------------------


def lift_off(phase: Transfer, tick: WalkTick) -> tuple[Swing | Settle, Events]:
    """Makes the swing of the next step; settles if the step cannot be taken.

    The feet are measured again: since touchdown the load has turned the soles flat. A
    foot on its toes is known from when it was flat.
    """
    # The delay of lift-off shortens the swing, by one tick at most.
    late = min(max(phase.elapsed - phase.duration, 0.0), tick.dt)
    feet, pitch, toeing = tick.observation.foot_poses, FLAT, phase.on_toes
    if toeing is not None:
        feet = with_foot(feet, toeing, phase.progress.feet[toeing])
        pitch = phase.leaving_pitch(phase.elapsed - late)
    time = tick.observation.time
    progress, news = with_warnings(replace(phase.progress, feet=feet), time)
    if not progress.coming:
        return make_settle(progress, phase.planned.cop, tick), news
    swing = make_swing(progress, tick, late, pitch)
    stance = 1 - swing.step.foot
    share = tick.balance.carrying_share(feet[stance])
    return swing, (*news, *partial_event(time, progress.last_index, stance, share))


def step_again(phase: Transfer, tick: WalkTick) -> tuple[Swing, Events]:
    """Makes the swing in which the foot that has just landed catches the DCM.

    The coming steps follow this step.
    """
    progress = phase.progress
    step = recovery_step(progress, tick, phase.airborne(tick))
    return _recover(progress, replace(step, index=progress.last_index), tick)


def catch(phase: WalkPhase, tick: WalkTick) -> tuple[Swing, Events]:
    """Makes the swing of a step that catches the DCM; no step was commanded."""
    airborne = phase.airborne(tick)
    feet = set_down(tick.observation.foot_poses, airborne)
    progress = replace(phase.progress, feet=feet)
    return _recover(progress, recovery_step(progress, tick, airborne), tick)


def _recover(
    progress: WalkProgress, step: Footstep, tick: WalkTick
) -> tuple[Swing, Events]:
    pending = progress.beginning_with(step)
    in_place = tick.config.in_place.most if len(pending) == 1 else 0
    if in_place:
        pending += (step_in_place(step, tick),)
    progress = replace(
        progress,
        aimed=progress.feet,
        pending=pending,
        next_index=step.index,
        last_foot=None,
        recovery_index=step.index,
        in_place=in_place,
    )
    event = recovery_event(tick.observation.time, step)
    return make_swing(progress, tick), (event,)


def make_swing(
    progress: WalkProgress, tick: WalkTick, late: float = 0.0, pitch: Pitch = FLAT
) -> Swing:
    """Makes the swing of the next step, shortened by ``late`` [s].

    The foot leaves the ground with a ``pitch`` about its toes.
    """
    config, feet, step = tick.config, progress.feet, progress.coming[0]
    start, stance = feet[step.foot], feet[1 - step.foot]
    length = 2.0 * tick.half_length
    duration = config.timing.swing(step.duration) - late
    cop = stance_cop(feet, step, config)
    begun = replace(
        progress,
        in_air=step,
        pending=tuple(s for s in progress.pending if s.index > step.index),
        next_index=step.index + 1,
        last_foot=step.foot,
        last_index=step.index,
    )
    onward = begun.coming[1].pose if len(begun.coming) > 1 else None
    if tick.balance.airborne(tick.observation, feet) == step.foot:
        sole = tick.observation.terms.feet[step.foot]
        pose, velocity = tick.observation.foot_pose(step.foot), sole.V_WF[3:5]
        duration *= 1.0 - config.swing.apex
        motion, step = swing_from_the_air(pose, velocity, step, duration, config.swing)
        begun = replace(begun, in_air=step)
    else:
        motion = begin_swing(
            start,
            duration,
            tick.half_length,
            pitch,
            config.roll.landing(stance, step.pose, onward),
            way_around(step, start, stance, config.limits.passing, length),
        )
    swing = Swing(
        progress=begun,
        plan=tick.plan(begun, cop, duration, motion),
        support=tick.balance.support(stance),
        duration=duration,
        sent=next(s for s in progress.pending if s.index == step.index),
        planned_step=step,
        motion=motion,
        sensitivity=landing_sensitivity(
            cop, duration, feet, begun.coming, config, tick.pendulum
        ),
        stops=onward is None,
    )
    return keep_balance(swing, tick)


def keep_balance(phase: Swing, tick: WalkTick) -> Swing:
    """Moves the landing, in place and time, when the ankles cannot hold the DCM.

    The foot then turns as far as a push has turned the pelvis: a hip that kept the
    foot's heading would have to stop the turn.
    """
    rules, remaining = tick.config.rules, phase.duration - phase.elapsed
    if remaining < rules.frozen_end:
        return phase
    step, motion, planned = phase.step, phase.motion, phase.planned
    omega = tick.pendulum.omega
    state = SingleSupportState(
        dcm=tick.dcm,
        planned_dcm=planned.dcm + math.exp(-omega * remaining) * phase.beyond_plan,
        cop=planned.cop,
        omega=omega,
        remaining=remaining,
        sensitivity=phase.accepted_sensitivity,
        stance=phase.stance,
        sole=tick.sole,
    )
    moved, left, _ = touchdown_for_balance(
        step,
        state,
        motion.progress,
        motion.xy,
        tick.config.adjustment,
        tick.config.limits_for_balance,
    )
    shift = float(np.abs(moved.p_WF - step.p_WF).max())
    if shift < rules.replan_shift and left == remaining:
        return phase
    yaw = phase.sent.yaw + tick.pelvis_turn
    yaw = saturated_heading(yaw, step.foot, phase.stance, tick.config.limits)
    moved = replace(moved, yaw=yaw)
    sooner = remaining - left
    duration, motion = phase.duration - sooner, motion.landing_sooner(sooner)
    progress = replace(phase.progress, in_air=moved)
    cop = stance_cop(progress.feet, moved, tick.config)
    return replace(
        phase,
        progress=progress,
        plan=tick.plan(progress, cop, duration, motion),
        stops=len(progress.coming) == 1,
        duration=duration,
        motion=motion,
    )


# ---- both feet are down ------------------------------------------------------


def land(phase: Swing, tick: WalkTick) -> tuple[Transfer | Settle, Events]:
    """Makes the phase after a touchdown, and reports the footstep."""
    step, landed = phase.step, tick.observation.foot_pose(phase.step.foot)
    pitch, aimed = 0.0, phase.motion.landing_pitch
    if aimed:
        sign = math.copysign(1.0, aimed)
        pitch = sign * max(sign * pitch_from(landed, step.normal), 0.0)
        # The foot rolls flat about heel or toes, and counts as flat from now on.
        landed = pitched_pose(landed, -pitch, sign * phase.motion.half_length)
    progress = replace(
        phase.progress,
        in_air=None,
        feet=with_foot(phase.progress.feet, step.foot, landed),
        aimed=with_foot(phase.progress.aimed, step.foot, step.pose),
    )
    cop, early = phase.planned.cop, phase.duration - phase.elapsed
    # A step of the walk's own was not commanded to any other place.
    sent = step if progress.last_was_recovery else phase.sent
    time = tick.observation.time
    events = (
        footstep_event(time, sent, step, landed),
        *contact_event(time, step, early),
    )
    if progress.in_place:
        progress = _go_on_in_place(progress, replace(step, p_WF=landed.p_WF), tick)
    # After a swing that stops, the DCM is near the middle of the feet. Steps that came
    # too late for its plan begin with a weight shift from rest.
    if phase.stops or not progress.coming:
        return make_settle(progress, cop, tick), events
    return make_transfer(progress, cop, early, pitch, tick), events


def _go_on_in_place(
    progress: WalkProgress, landing: Footstep, tick: WalkTick
) -> WalkProgress:
    """Returns the progress with another step in place, or the last one once quiet."""
    if not is_quiet(tick):
        left, following = progress.in_place - 1, step_in_place(landing, tick)
    else:
        left, following = 0, square_up_step(landing, tick)
        away = landing_error(following, progress.feet[following.foot])
        if away < tick.config.rules.feet_apart:
            return replace(progress, pending=(), in_place=0)
    return replace(
        progress,
        pending=(following,),
        recovery_index=following.index,
        in_place=left,
    )


def make_transfer(
    progress: WalkProgress, cop: np.ndarray, early: float, landed: float, tick: WalkTick
) -> Transfer:
    """Makes the transfer to a foot that landed ``early`` [s] with a pitch [rad]."""
    config, step = tick.config, progress.coming[0]
    # The next touchdown is planned one step duration after this planned touchdown.
    duration = config.timing.transfer(step.duration)
    change = config.rules.transfer_change * duration
    duration += min(max(early, -change), change)
    rear, front = progress.feet[step.foot], progress.feet[1 - step.foot]
    # Below the toes of a sole that carries in part only there may be no ground.
    whole = rear.part is None
    toe_off = config.roll.leaving(rear, front) if whole else 0.0
    return Transfer(
        progress=progress,
        plan=tick.plan(progress, cop, duration),
        support=tick.support(progress.feet, step.foot if toe_off else None),
        duration=duration,
        unloading=step.foot,
        toe_off=toe_off,
        landed=landed,
    )


def make_settle(progress: WalkProgress, cop: np.ndarray, tick: WalkTick) -> Settle:
    """Makes the end of a walk, from a CoP reference in W [m], shape (2,)."""
    duration = tick.config.timing.settle
    return Settle(
        progress=progress,
        plan=tick.plan(progress, cop, duration),
        support=tick.support(progress.feet),
        duration=duration,
    )


def shift_weight(
    progress: WalkProgress, dcm: np.ndarray, cop: np.ndarray, tick: WalkTick
) -> Transfer:
    """Makes the weight shift from rest, with DCM and CoP in W [m], shape (2,)."""
    support = tick.support(progress.feet)
    duration = tick.config.timing.first_shift
    plan = tick.plan(progress, cop, duration)
    return Transfer(
        progress=progress,
        plan=begun_at(plan, dcm, support),
        support=support,
        duration=duration,
        unloading=progress.coming[0].foot if progress.coming else None,
        from_rest=True,
    )


def steps_left_out(phase: Settle, tick: WalkTick) -> Events:
    """Makes an event of the steps that the walk leaves out, if any."""
    progress = phase.progress
    if progress.pending:
        left = [step.index for step in progress.pending]
        text = f"WALK ends without the steps {', '.join(map(str, left[:NAMED]))}"
        if len(left) > NAMED:
            text += f" and {len(left) - NAMED} more"
        if phase.obstacle:
            text += f": {phase.obstacle}"
    elif progress.last_foot is None and not tick.leaving:
        text = "WALK ends without a step: walk_params.step_queue has none"
    else:
        return ()
    return (Event(tick.observation.time, STEPS_LEFT, text),)
