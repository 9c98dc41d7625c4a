"""Steps that nobody commanded: they catch a lost DCM, and bring the feet together."""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.walk.phase import WalkTick
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.control.balance.step_adjustment import (
    SingleSupportState,
    Touchdown,
    touchdown_for_balance,
)
from atlas_drake.control.feet.footstep import landing_error, outward
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z


def recovery_step(
    progress: WalkProgress, tick: WalkTick, airborne: int | None = None
) -> Footstep:
    """Makes the step that catches a lost DCM at the least cost.

    An ``airborne`` foot steps; if both are down, any foot may. A step beside the other
    foot, after which the robot would be at rest over it, is moved for balance.
    """
    config, omega = tick.config, tick.pendulum.omega
    width, height = tick.balance.stance.width, config.swing.height
    shortest = config.limits.duration.least
    remaining = config.timing.swing(shortest)

    def of(foot: int) -> Touchdown:
        stance = progress.feet[1 - foot]
        step = _beside(stance, progress.next_index, foot, width, shortest, height)
        cop, there = stance.p_WF[:2], step.p_WF[:2]
        state = SingleSupportState(
            dcm=tick.dcm,
            planned_dcm=cop + math.exp(-omega * remaining) * (there - cop),
            cop=cop,
            omega=omega,
            remaining=remaining,
            sensitivity=1.0,
            stance=stance,
            sole=tick.sole,
        )
        return touchdown_for_balance(
            step,
            state,
            0.0,
            progress.feet[foot].p_WF[:2],
            config.adjustment,
            config.limits,
        )

    free = (LEFT, RIGHT) if airborne is None else (airborne,)
    return min(map(of, free), key=lambda found: found.cost).step


def may_step_again(progress: WalkProgress, tick: WalkTick) -> bool:
    """Returns True if the foot that has just landed is the one to catch the DCM."""
    foot = progress.last_foot
    return foot is not None and recovery_step(progress, tick).foot == foot


def needs_square_up(progress: WalkProgress, tick: WalkTick) -> bool:
    """Returns True if the feet stand apart after a recovery step."""
    if not progress.last_was_recovery or progress.last_foot is None:
        return False
    step = square_up_step(progress, progress.last_foot, tick)
    away = landing_error(step, progress.feet[step.foot])
    return away >= tick.config.rules.feet_apart


def square_up_step(progress: WalkProgress, other: int, tick: WalkTick) -> Footstep:
    """Makes the step that puts a foot beside the ``other`` one."""
    config, index = tick.config, progress.next_index
    usual, width = config.steps.duration, tick.balance.stance.width
    stance, height = progress.feet[other], config.swing.height
    return _beside(stance, index, 1 - other, width, usual, height)


def step_in_place(landing: Footstep, tick: WalkTick) -> Footstep:
    """Makes the quick step of the other foot that follows a ``landing``."""
    config, in_place = tick.config, tick.config.in_place
    width = in_place.width * tick.balance.stance.width
    height = in_place.height * config.swing.height
    shortest, index = config.limits.duration.least, landing.index + 1
    return _beside(landing.pose, index, 1 - landing.foot, width, shortest, height)


def is_quiet(progress: WalkProgress, tick: WalkTick) -> bool:
    """Returns True if the robot comes to rest on its feet without another step."""
    left, right = (foot.p_WF[:2] for foot in progress.feet)
    vx, vy, _ = tick.observation.terms.com_velocity.tolist()
    in_place = tick.config.in_place
    apart = float(np.hypot(*(left - right)))
    return apart < in_place.quiet_apart and math.hypot(vx, vy) < in_place.quiet_speed


def _beside(
    stance: FootPose,
    index: int,
    foot: int,
    width: float,
    duration: float,
    height: float,
) -> Footstep:
    """Makes a step to the side of a stance foot."""
    beside = outward(foot) * width * rotation_z(stance.yaw)[:, 1]
    return Footstep(index, foot, stance.p_WF + beside, stance.yaw, duration, height)
