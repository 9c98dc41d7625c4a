"""Steps that nobody commanded: they catch a lost DCM, and bring the feet together."""

from __future__ import annotations

import math

from atlas_drake.behaviors.walk.phase import WalkTick
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.control.balance.step_adjustment import (
    SingleSupportState,
    Touchdown,
    touchdown_for_balance,
)
from atlas_drake.control.feet.footstep import outward
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


def step_in_place(landing: Footstep, tick: WalkTick) -> Footstep:
    """Makes the quick step of the other foot that follows a ``landing``."""
    config, in_place = tick.config, tick.config.in_place
    width = in_place.width * tick.balance.stance.width
    height = in_place.height * config.swing.height
    shortest, index = config.limits.duration.least, landing.index + 1
    return _beside(landing.pose, index, 1 - landing.foot, width, shortest, height)


def square_up_step(landing: Footstep, tick: WalkTick) -> Footstep:
    """Makes the usual step that puts the other foot beside that of a ``landing``."""
    config, index = tick.config, landing.index + 1
    usual, width = config.steps.duration, tick.balance.stance.width
    height = config.swing.height
    return _beside(landing.pose, index, 1 - landing.foot, width, usual, height)


def is_quiet(tick: WalkTick) -> bool:
    """Returns True if the robot comes to rest without another quick step."""
    vx, vy, _ = tick.observation.terms.com_velocity.tolist()
    return math.hypot(vx, vy) < tick.config.in_place.quiet_speed


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
