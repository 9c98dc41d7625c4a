"""The limits of a step: reach, height, duration; and its error on landing.

Geometry only; the timing of a gait is elsewhere.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.control.feet.curves import quintic_progress, rise_and_fall
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, UP, FootPose, Footstep
from atlas_drake.rotations import rotation_z, wrap_angle

_PLACES = 5
"""Number of places at which the distance of passing feet is looked at."""
_LEAST_ASIDE = 0.5
"""Least share of the displacement that counts where feet pass: nearer to an end of the
way a foot would have to swing far aside for little [-]."""
_PROGRESS = np.linspace(0.0, 1.0, 41)
_WAY, _ASIDE = (
    np.array([curve(progress)[0] for progress in _PROGRESS.tolist()])
    for curve in (quintic_progress, lambda progress: rise_and_fall(progress, 0.5))
)
"""Share of the way, and of the displacement aside, at some progress of a swing [-]."""


def outward(foot: int) -> float:
    """Returns the sign of y that points away from the other foot."""
    return 1.0 if foot == LEFT else -1.0


def resolve_height(step: Footstep, stance: FootPose, limits: StepLimits) -> Footstep:
    """Returns the step with its height in W.

    A height beyond ``limits.meant_rise`` is ignored together with the normal:
    the step is then level with the stance foot.
    """
    x, y, z = step.p_WF
    ground = float(stance.p_WF[2])
    if step.relative:
        return replace(step, p_WF=np.array([x, y, ground + z]), relative=False)
    if abs(z - ground) <= limits.meant_rise:
        return step
    return replace(step, p_WF=np.array([x, y, ground]), normal=UP)


def saturated_heading(
    yaw: float, foot: int, stance: FootPose, limits: StepLimits
) -> float:
    """Returns the heading nearest to ``yaw`` in which a foot can land [rad]."""
    sign = outward(foot)
    turn = sign * wrap_angle(yaw - stance.yaw)
    return stance.yaw + sign * clip(turn, -limits.toe_in, limits.toe_out)


def saturate(step: Footstep, stance: FootPose, limits: StepLimits) -> Footstep:
    """Returns the step nearest to ``step`` that the robot can take from ``stance``."""
    R_WS = rotation_z(stance.yaw)
    sign = outward(step.foot)
    p_SF = R_WS.T @ (step.p_WF - stance.p_WF)
    aside = clip(sign * p_SF[1], *limits.width)
    longest = limits.longest_ahead(aside)
    reach = np.array(
        [
            clip(p_SF[0], -min(limits.backward, longest), min(limits.forward, longest)),
            sign * aside,
            clip(p_SF[2], -limits.rise, limits.rise),
        ]
    )
    return replace(
        step,
        p_WF=stance.p_WF + R_WS @ reach,
        yaw=saturated_heading(step.yaw, step.foot, stance, limits),
        duration=clip(step.duration, *limits.duration),
        swing_height=clip(step.swing_height, *limits.swing_height),
        normal=_tilted_at_most(step.normal, limits.tilt),
    )


def ensure_clearance(step: Footstep, start: FootPose, limits: StepLimits) -> Footstep:
    """Returns the step with a swing high enough for its difference in height.

    The lowest swing grows with the climb, so that the foot also clears the higher end
    by more.
    """
    climb = abs(float(step.p_WF[2] - start.p_WF[2]))
    least, greatest = limits.swing_height
    lowest = min(least + climb, greatest)
    return replace(step, swing_height=max(step.swing_height, lowest))


def way_around(
    step: Footstep, start: FootPose, stance: FootPose, least: float, length: float
) -> np.ndarray:
    """Computes how far aside a foot must swing so that it passes the other leg.

    On the straight way from ``start`` it would come nearer to a stance foot that has
    turned.

    Args:
        step: Where the foot goes.
        start: Where it lifts off.
        stance: The other foot.
        least: Least lateral distance between the feet [m].
        length: Of the part of the way, around the stance foot, on which they pass [m].

    Returns:
        Displacement of the way's middle in W [m], shape (2,); zero where there is room.
    """
    R_WS = rotation_z(stance.yaw)[:2, :2]
    sign = outward(step.foot)
    ends = [R_WS.T @ (pose.p_WF - stance.p_WF)[:2] for pose in (start, step)]
    (x0, y0), (x1, y1) = ends
    beside = 0.5 * length
    if x0 * x1 >= 0.0 or min(abs(x0), abs(x1)) < beside:  # Its end is beside the foot.
        return np.zeros(2)
    passed = (np.linspace(-beside, beside, _PLACES) - x0) / (x1 - x0)
    short = least - sign * (y0 + passed * (y1 - y0))
    # The displacement is that of the middle; where the feet pass, it may be smaller.
    aside = np.maximum(np.interp(passed, _WAY, _ASIDE), _LEAST_ASIDE)
    needed = float((short / aside).max())
    return sign * max(needed, 0.0) * R_WS[:, 1]


def longest_duration(apart: float, limits: StepLimits) -> float:
    """Computes the longest time that a step may take [s].

    ``apart`` is the largest distance between the feet, before the step or after it [m].
    """
    share = clip((apart - limits.near) / (limits.far - limits.near), 0.0, 1.0)
    longest = limits.duration.greatest
    return longest + share * (limits.far_duration - longest)


def shortest_duration(climb: float, limits: StepLimits) -> float:
    """Computes the shortest time that a step may take [s].

    ``climb`` is the largest difference in height between the feet, before the step or
    after it [m].
    """
    shortest = limits.duration.least
    if limits.rise <= limits.easy_rise:
        return shortest
    share = (climb - limits.easy_rise) / (limits.rise - limits.easy_rise)
    return shortest + clip(share, 0.0, 1.0) * (limits.rise_duration - shortest)


def limit_duration(
    step: Footstep, start: FootPose, stance: FootPose, limits: StepLimits
) -> Footstep:
    """Returns the step with its duration limited by the place of the feet.

    Their larger distance, before the step or after it, gives the longest duration, and
    their larger difference in height the shortest.
    """
    ways = [place - stance.p_WF for place in (start.p_WF, step.p_WF)]
    longest = longest_duration(max(math.hypot(*way[:2]) for way in ways), limits)
    shortest = shortest_duration(max(abs(float(way[2])) for way in ways), limits)
    return replace(step, duration=min(max(step.duration, shortest), longest))


def _tilted_at_most(normal: np.ndarray, tilt: float) -> np.ndarray:
    """Limits the angle of ``normal`` from the vertical to ``tilt`` [rad]."""
    across = math.hypot(normal[0], normal[1])
    if math.atan2(across, normal[2]) <= tilt:
        return normal
    if across == 0.0:  # Straight down: no direction is nearer than another.
        return UP
    share = math.sin(tilt) / across
    return np.array([normal[0] * share, normal[1] * share, math.cos(tilt)])


def clip(value: float, low: float, high: float) -> float:
    """Returns the number from ``low`` to ``high`` that is nearest to ``value``."""
    return float(min(max(value, low), high))


def landing_error(step: Footstep, landed: FootPose) -> float:
    """Computes the horizontal distance from the commanded to the actual landing [m]."""
    return math.hypot(*(landed.p_WF - step.p_WF)[:2])


def heading_error(step: Footstep, landed: FootPose) -> float:
    """Computes the angle between the commanded and the actual heading [rad]."""
    return abs(wrap_angle(landed.yaw - step.yaw))
