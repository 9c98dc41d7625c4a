"""Steps that nobody commanded: they catch a lost DCM, and bring the feet together.

The capture point of a pendulum on a fixed center of pressure is that of Pratt, Carff,
Drakunov, Goswami, "Capture point: a step toward humanoid push recovery", Humanoids
2006.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.walk.phase import WalkTick
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.control.feet.footstep import landing_error, outward, saturate
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z


def recovery_step(
    progress: WalkProgress,
    tick: WalkTick,
    airborne: int | None = None,
    *,
    goes_on: bool = False,
) -> Footstep:
    """Makes the step to the DCM of its touchdown: ξ_T = r + e^{ωT}(ξ - r).

    An ``airborne`` foot steps; if both are down, the foot that gets nearer to ξ_T. The
    CoP r is the point of the other sole that is nearest to the DCM ξ. The time T is
    that of a quick swing, though balance may hasten it: the robot stops more surely
    behind a long step. Sideways the DCM leaves the stance foot in any case. There T is
    that of the fastest swing, unless the robot moves sideways as fast as ahead or back.
    In a walk that ``goes_on`` T is always that of the fastest swing.
    """
    config, dcm, omega = tick.config, tick.dcm, tick.pendulum.omega
    com = tick.observation.terms.com[:2]
    free = (LEFT, RIGHT) if airborne is None else (airborne,)
    duration = config.limits.duration.least
    fast = math.exp(omega * config.adjustment.shortest_swing)
    usual = fast if goes_on else math.exp(omega * config.timing.swing(duration))

    def step_of(foot: int) -> tuple[float, Footstep]:
        """The step of one foot, and its distance from ξ_T [m]."""
        stance = progress.feet[1 - foot]
        R = rotation_z(stance.yaw)[:2, :2]
        ahead, aside = np.abs(R.T @ (dcm - com)).tolist()
        sideways = aside / (max(ahead, aside) or 1.0)
        growth = np.array([usual, fast + sideways * (usual - fast)])
        cop = tick.balance.support(stance).clamp(dcm)
        point = cop + R @ (growth * (R.T @ (dcm - cop)))
        p_WF, height = np.append(point, stance.p_WF[2]), config.swing.height
        step = Footstep(progress.next_index, foot, p_WF, stance.yaw, duration, height)
        step = saturate(step, stance, config.limits)
        return float(np.hypot(*(step.p_WF[:2] - point))), step

    return min(map(step_of, free), key=lambda found: found[0])[1]


def may_step_again(progress: WalkProgress, tick: WalkTick) -> bool:
    """Returns True if the foot that has just landed is the one to catch the DCM.

    The DCM has left its sole mainly to the outer side, where the other foot would have
    to cross, and the other foot gets less near to the DCM. Ahead and behind the other
    foot steps as it would have.
    """
    foot = progress.last_foot
    if foot is None:
        return False
    pose = progress.feet[foot]
    beyond_W = tick.dcm - tick.balance.support(pose).clamp(tick.dcm)
    ahead, left = rotation_z(pose.yaw)[:2, :2].T @ beyond_W
    if outward(foot) * left <= abs(ahead):
        return False
    return recovery_step(progress, tick, goes_on=True).foot == foot


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
