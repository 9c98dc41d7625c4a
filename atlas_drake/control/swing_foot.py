"""Motion of a swinging sole from lift-off to landing.

Horizontal motion follows a quintic that is solved anew every tick from its own
present reference, so that the landing place may move during the swing without a
jump. Knows nothing of balance or of why the target moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from atlas_drake.control.footstep import FootPose, Footstep
from atlas_drake.control.rotations import (
    rotation_y,
    rotation_z,
    wrap_angle,
)


@dataclass(frozen=True)
class SwingProfile:
    """How a swing looks, whatever the step."""

    press_depth: float = 0.005
    """Landing is aimed this far below the ground, so that it is not missed [m]."""
    late_descent: float = 0.15
    """Speed at which a foot that found no ground goes on down [m/s]."""
    toe_down: float = 1.6
    """Pitch of the toes at the apex per metre of swing height [rad/m]."""


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
    if elapsed < swing.duration:
        xy, velocity, acceleration = quintic_step(
            swing.xy,
            swing.xy_velocity,
            swing.xy_acceleration,
            target.p_WF[:2],
            max(swing.remaining, 2.0 * dt),
            dt,
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


def _reference(swing: Swing, target: Footstep, profile: SwingProfile) -> SwingReference:
    z, vz, az = _height(swing, target, profile)
    s, ds, _ = quintic_progress(swing.progress)
    rate = ds / swing.duration if swing.elapsed < swing.duration else 0.0
    turn = wrap_angle(target.yaw - swing.start.yaw)
    tipped, tip_rate, _ = bump(swing.progress)
    toes = profile.toe_down * target.swing_height
    yaw_now = swing.start.yaw + s * turn
    pitch_rate = toes * tip_rate / swing.duration
    return SwingReference(
        p_WF=np.array([swing.xy[0], swing.xy[1], z]),
        v_WF=np.array([swing.xy_velocity[0], swing.xy_velocity[1], vz]),
        a_WF=np.array([swing.xy_acceleration[0], swing.xy_acceleration[1], az]),
        R_WF=rotation_z(yaw_now) @ rotation_y(toes * tipped),
        w_WF=np.array(
            [
                -math.sin(yaw_now) * pitch_rate,
                math.cos(yaw_now) * pitch_rate,
                turn * rate,
            ]
        ),
    )


def _height(
    swing: Swing, target: Footstep, profile: SwingProfile
) -> tuple[float, float, float]:
    """Height of the sole, its rate and acceleration: a bump on a smooth ramp."""
    T = swing.duration
    z0, z1 = swing.start.p_WF[2], target.p_WF[2] - profile.press_depth
    if swing.elapsed >= T:
        late = swing.elapsed - T
        return z1 - profile.late_descent * late, -profile.late_descent, 0.0
    s, ds, dds = quintic_progress(swing.progress)
    b, db, ddb = bump(swing.progress)
    # The bump counts from the straight line between the ends; raise it so that the
    # apex clears the higher end by the full swing height.
    height = target.swing_height + 0.5 * abs(z1 - z0)
    return (
        z0 + (z1 - z0) * s + height * b,
        ((z1 - z0) * ds + height * db) / T,
        ((z1 - z0) * dds + height * ddb) / (T * T),
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
    d = goal - p - v * T - 0.5 * a * T * T
    e = -v - a * T
    f = -a
    c3 = (10.0 * d - 4.0 * e * T + 0.5 * f * T * T) / T**3
    c4 = (-15.0 * d + 7.0 * e * T - f * T * T) / T**4
    c5 = (6.0 * d - 3.0 * e * T + 0.5 * f * T * T) / T**5
    t = dt
    return (
        p + v * t + 0.5 * a * t * t + c3 * t**3 + c4 * t**4 + c5 * t**5,
        v + a * t + 3.0 * c3 * t * t + 4.0 * c4 * t**3 + 5.0 * c5 * t**4,
        a + 6.0 * c3 * t + 12.0 * c4 * t * t + 20.0 * c5 * t**3,
    )
