"""Motion of a swinging sole from lift-off to landing.

Horizontal motion follows a quintic that is solved anew every tick from its own
present reference, so that the landing place may move during the swing without a
jump. Knows nothing of balance or of why the target moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.footstep import FootPose, Footstep
from atlas_drake.control.rotations import (
    rotation_with_normal,
    rotation_y,
    wrap_angle,
)
from atlas_drake.frozen import replace


@dataclass(frozen=True)
class SwingProfile:
    """How a swing looks, whatever the step."""

    press_depth: float = 0.005
    """Landing is aimed this far below the ground, so that it is not missed [m]."""
    late_descent: float = 0.15
    """Speed at which a foot that found no ground goes on down [m/s]."""
    toe_down: float = 1.6
    """Pitch of the toes at the apex per metre of swing height [rad/m]; climbing does
    without it, lest the toes catch the edge."""
    climb_share: float = 0.5
    """Share of the swing in which a difference in height is overcome: the first one
    upwards, the last one downwards, which keeps the sole off the edge [-]."""
    edge_share: float = 0.25
    """Share of the swing at that end in which the foot keeps still horizontally, when
    there is an edge between the ends [-]."""
    edge_height: float = 0.04
    """Difference in height from which on an edge is one in full [m]."""


@dataclass(frozen=True)
class Swing:
    """Reference of the swinging sole, advanced by one tick at a time.

    Attributes:
        start: Pose at lift-off.
        duration: Of the swing [s].
        elapsed: Time since lift-off [s].
        xy, xy_velocity, xy_acceleration: Horizontal reference in W, shape (2,).
    """

    start: FootPose
    duration: float
    elapsed: float
    xy: np.ndarray
    xy_velocity: np.ndarray
    xy_acceleration: np.ndarray

    @property
    def remaining(self) -> float:
        """Time to the planned touchdown [s]."""
        return max(self.duration - self.elapsed, 0.0)

    @property
    def progress(self) -> float:
        """Share of the swing that is over, 0 to 1."""
        return min(self.elapsed / self.duration, 1.0)


@dataclass(frozen=True)
class SwingReference:
    """Where the sole shall be now: position, velocity, acceleration in W."""

    p_WF: np.ndarray
    v_WF: np.ndarray
    a_WF: np.ndarray
    R_WF: np.ndarray
    w_WF: np.ndarray


def begin_swing(start: FootPose, duration: float) -> Swing:
    """A swing that lifts off from ``start`` at rest."""
    zero = np.zeros(2)
    return Swing(start, duration, 0.0, start.p_WF[:2].copy(), zero, zero)


def advance_swing(
    swing: Swing, target: Footstep, profile: SwingProfile, dt: float
) -> tuple[Swing, SwingReference]:
    """Moves the swing on by ``dt`` [s] towards ``target``."""
    elapsed = swing.elapsed + dt
    begin, end = _horizontal_window(swing, target, profile)
    if elapsed < begin:
        xy, velocity, acceleration = swing.xy, np.zeros(2), np.zeros(2)
    elif elapsed < end:
        since = max(swing.elapsed, begin)
        xy, velocity, acceleration = quintic_step(
            swing.xy,
            swing.xy_velocity,
            swing.xy_acceleration,
            target.p_WF[:2],
            max(end - since, 2.0 * dt),
            elapsed - since,
        )
    else:
        xy, velocity, acceleration = swing.xy, np.zeros(2), np.zeros(2)
    moved = replace(
        swing,
        elapsed=elapsed,
        xy=xy,
        xy_velocity=velocity,
        xy_acceleration=acceleration,
    )
    return moved, _reference(moved, target, profile)


def _horizontal_window(
    swing: Swing, target: Footstep, profile: SwingProfile
) -> tuple[float, float]:
    """When the foot begins and ends to move horizontally, in time since lift-off [s].

    Up an edge it rises first, down an edge it sinks last.
    """
    climb = float(target.p_WF[2] - swing.start.p_WF[2])
    edge = min(abs(climb) / profile.edge_height, 1.0)
    still = profile.edge_share * edge * swing.duration
    if climb > 0.0:
        return still, swing.duration
    return 0.0, swing.duration - still


def _reference(swing: Swing, target: Footstep, profile: SwingProfile) -> SwingReference:
    z, vz, az = _height(swing, target, profile)
    s, ds, _ = quintic_progress(swing.progress)
    rate = ds / swing.duration if swing.elapsed < swing.duration else 0.0
    tipped, tip_rate, _ = bump(swing.progress)
    toes = _toe_pitch(swing, target, profile)
    R, w = _sole_on_ground(swing.start, target, s, rate)
    return SwingReference(
        p_WF=np.array([swing.xy[0], swing.xy[1], z]),
        v_WF=np.array([swing.xy_velocity[0], swing.xy_velocity[1], vz]),
        a_WF=np.array([swing.xy_acceleration[0], swing.xy_acceleration[1], az]),
        R_WF=R @ rotation_y(toes * tipped),
        w_WF=w + R[:, 1] * (toes * tip_rate / swing.duration),
    )


def _sole_on_ground(
    start: FootPose, target: Footstep, s: float, rate: float
) -> tuple[np.ndarray, np.ndarray]:
    """Orientation between start and target, were the foot not lifted, and its rate.

    Heading and normal go from one to the other with the progress ``s``, 0 to 1, which
    grows at ``rate`` [1/s].
    """
    start_yaw, start_normal = start.yaw, start.R_WF[:, 2]
    turn = wrap_angle(target.yaw - start_yaw)
    yaw = start_yaw + s * turn
    difference = target.normal - start_normal
    along = start_normal + s * difference
    length = math.sqrt(along @ along)
    normal = along / length
    tilting = rate / length * (difference - normal * (normal @ difference))
    R = rotation_with_normal(yaw, normal)
    # The turn about the normal follows from x staying above the heading: x goes along
    # u = [cos, sin, slope], and only the part of u's rate along y turns it.
    c, si, yaw_rate = math.cos(yaw), math.sin(yaw), turn * rate
    n, t = normal.tolist(), tilting.tolist()
    slope = -(c * n[0] + si * n[1]) / n[2]
    slope_rate = (
        yaw_rate * (si * n[0] - c * n[1]) - (c * t[0] + si * t[1]) - slope * t[2]
    ) / n[2]
    y = R[:, 1].tolist()
    along_y = yaw_rate * (c * y[1] - si * y[0]) + slope_rate * y[2]
    spin = along_y / math.sqrt(1.0 + slope * slope)
    w = np.array(
        [
            n[1] * t[2] - n[2] * t[1] + spin * n[0],
            n[2] * t[0] - n[0] * t[2] + spin * n[1],
            n[0] * t[1] - n[1] * t[0] + spin * n[2],
        ]
    )
    return R, w


def _toe_pitch(swing: Swing, target: Footstep, profile: SwingProfile) -> float:
    """Pitch of the toes at the apex [rad]; none for a climb as high as the swing."""
    climb = max(float(target.p_WF[2] - swing.start.p_WF[2]), 0.0)
    return profile.toe_down * max(target.swing_height - climb, 0.0)


def _height(
    swing: Swing, target: Footstep, profile: SwingProfile
) -> tuple[float, float, float]:
    """Height of the sole, its rate and acceleration: a bump on smooth ramps.

    One ramp is the climb from the ground here to the ground there, the other one
    presses the foot into that ground.
    """
    T = swing.duration
    z0 = float(swing.start.p_WF[2])
    climb, press = float(target.p_WF[2]) - z0, -profile.press_depth
    if swing.elapsed >= T:
        late = swing.elapsed - T
        z1 = z0 + climb + press
        return z1 - profile.late_descent * late, -profile.late_descent, 0.0
    share = profile.climb_share
    begin = 0.0 if climb > 0.0 else 1.0 - share
    r, dr, ddr = quintic_progress(min(max((swing.progress - begin) / share, 0.0), 1.0))
    s, ds, dds = quintic_progress(swing.progress)
    b, db, ddb = bump(swing.progress)
    # Midway, where the bump is highest, the foot has climbed to the higher end and is
    # pressed down by half the depth.
    height = target.swing_height - 0.5 * abs(climb) - 0.5 * press
    return (
        z0 + climb * r + press * s + height * b,
        (climb * dr / share + press * ds + height * db) / T,
        (climb * ddr / share**2 + press * dds + height * ddb) / (T * T),
    )


def bump(s: float) -> tuple[float, float, float]:
    """64 s³(1-s)³ with its first and second derivative: 0 at both ends, 1 midway."""
    r = 1.0 - s
    p = s * r
    return (
        64.0 * p**3,
        192.0 * p * p * (r - s),
        384.0 * p * ((r - s) ** 2 - p),
    )


def quintic_progress(s: float) -> tuple[float, float, float]:
    """10s³ - 15s⁴ + 6s⁵ with its first and second derivative."""
    r = 1.0 - s
    return (
        s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
        30.0 * s * s * r * r,
        60.0 * s * r * (r - s),
    )


def quintic_step(
    p: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    goal: np.ndarray,
    T: float,
    dt: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """State after ``dt`` on the quintic from (p, v, a) to rest at ``goal`` in ``T``."""
    # On floats: numpy's own arithmetic on vectors of two costs ten times as much.
    after = []
    for x, vx, ax, goal_x in zip(
        p.tolist(), v.tolist(), a.tolist(), goal.tolist(), strict=True
    ):
        d = goal_x - x - vx * T - 0.5 * ax * T * T
        e = -(vx + ax * T) * T
        f = -0.5 * ax * T * T
        c3 = (10.0 * d - 4.0 * e + f) / T**3
        c4 = (-15.0 * d + 7.0 * e - 2.0 * f) / T**4
        c5 = (6.0 * d - 3.0 * e + f) / T**5
        t = dt
        after.append(
            (
                x + t * (vx + t * (0.5 * ax + t * (c3 + t * (c4 + t * c5)))),
                vx + t * (ax + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5))),
                ax + t * (6.0 * c3 + t * (12.0 * c4 + t * 20.0 * c5)),
            )
        )
    moved, speed, push = np.array(after).T
    return moved, speed, push
