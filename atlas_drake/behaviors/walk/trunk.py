"""The trunk in a walk: its height, its heading, and the lead that its turn follows."""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.body_reference import BodyTarget
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phase import WalkPhase, WalkTick
from atlas_drake.behaviors.walk.settle import Settle
from atlas_drake.behaviors.walk.swing import Swing
from atlas_drake.frozen import read_only
from atlas_drake.messages.footstep import LEFT
from atlas_drake.rotations import mean_yaw

_UPRIGHT = read_only(np.zeros(2))


def trunk_target(phase: WalkPhase, tick: WalkTick, nominal_height: float) -> BodyTarget:
    """Computes the target of trunk and posture.

    ``nominal_height`` is the height of the CoM above level ground [m].
    """
    config = tick.config
    left, right = phase.progress.feet_to_come
    low, high = sorted([float(left.p_WF[2]), float(right.p_WF[2])])
    if isinstance(phase, Swing) and not phase.may_sink(config.swing):
        low = float(phase.stance.p_WF[2])
    # With feet at different heights, now or after this step, raise the CoM as far as
    # the lower leg can stretch, so that the knee of the upper leg bends less: a bent
    # knee needs more torque. On its toes the lower foot's middle is higher.
    raised = tick.half_length * phase.lower_pitch
    ground = min(high, low + config.rules.leg_stretch + raised)
    rise = config.com_rise * _roll_share(phase, config)
    lead, rate = _lead(phase, tick.balance.sway.most_lead)
    return BodyTarget(
        height=ground + nominal_height + rise,
        yaw=mean_yaw(left.yaw, right.yaw),
        joints=tick.balance.robot.stand_prep,
        pelvis_tilt=_UPRIGHT,
        chest_tilt=_UPRIGHT,
        lead=lead,
        lead_rate=rate,
    )


def is_quick(phase: WalkPhase, tick: WalkTick) -> bool:
    """Returns True if the height of the center of mass may yield.

    It may if the present or next step is quick, on level ground. In a slow step, or up
    and down, a center of mass that sinks bends the knees beyond what they carry; one
    that sinks fast does so in any step.
    """
    coming, config = phase.progress.coming, tick.config
    if not coming or coming[0].duration > config.rules.quick_step:
        return False
    if tick.observation.terms.com_velocity[2] < -config.rules.quick_sink:
        return False
    places = (coming[0], *phase.progress.feet)
    heights = [float(place.p_WF[2]) for place in places]
    return max(heights) - min(heights) <= config.limits.level


def _roll_share(phase: WalkPhase, config: WalkConfig) -> float:
    """Returns the share of the soles' pitches in the present step, or the next."""
    coming, feet, roll = phase.progress.coming, phase.progress.feet, config.roll
    if not coming:
        return 0.0
    step = coming[0]
    start, stance = feet[step.foot], feet[1 - step.foot]
    return max(roll.share(start, stance), roll.share(stance, step.pose))


def _lead(phase: WalkPhase, most: float) -> tuple[float, float]:
    """Computes by how much the left foot leads, ``most`` at most [m], and its rate."""
    if isinstance(phase, Settle):
        return 0.0, 0.0
    left, right = phase.progress.feet
    (lx, ly), (rx, ry) = left.p_WF[:2].tolist(), right.p_WF[:2].tolist()
    vx = vy = 0.0
    if isinstance(phase, Swing):
        motion = phase.motion
        (x, y), (vx, vy) = motion.xy.tolist(), motion.xy_velocity.tolist()
        if phase.step.foot == LEFT:
            lx, ly = x, y
        else:
            rx, ry, vx, vy = x, y, -vx, -vy
    yaw = mean_yaw(left.yaw, right.yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    lead = c * (lx - rx) + s * (ly - ry)
    if abs(lead) > most:
        return math.copysign(most, lead), 0.0
    return lead, c * vx + s * vy
