"""Motion of a swinging sole from lift-off to landing.

Horizontal motion, heading, and pitch about toes and heel follow minimum-jerk quintics,
solved anew every tick from the present reference, so that place and heading of the
landing may change during the swing without a jump. The choice of the landing place is
in ``control.balance``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.config import Configuration, NotNegative, Positive, ProperShare, Share
from atlas_drake.control.feet.curves import (
    quintic_coefficients,
    quintic_progress,
    quintic_step,
    quintic_step_of_one,
    rise_and_fall,
)
from atlas_drake.control.feet.sole_motion import FLAT, Pitch, SoleMotion
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.rotations import cross, rotation_with_normal, wrap_angle
from atlas_drake.units import (
    Meters,
    MetersPerSecond,
    MetersPerSecondSquared,
    RadiansPerMeter,
    Seconds,
)

_LONGEST_LIFT = 0.1
"""Greatest share of a swing without horizontal motion on level ground; the rest is the
time of a hastened swing for its way [-]."""

STRAIGHT = read_only(np.zeros(2))
"""Displacement of a way that need not go around the other leg [m]."""
_SHORTEST_PUSH = 1e-3
"""Shorter parts of a swing are left out of its pushes [s]."""


@dataclass(frozen=True)
class SwingProfile(Configuration):
    """Parameters of the swing that are the same for all steps of WALK."""

    height: Positive[Meters] = 0.10
    """Apex above the middle of both ends, of steps that planners make; a step that is
    commanded brings its own."""
    landing_speed: Positive[MetersPerSecond] = 0.15
    """Speed of the sole at touchdown, and of its descent past the planned touchdown.
    The higher the speed, the smaller the timing error from an error of height."""
    late_acceleration: NotNegative[MetersPerSecondSquared] = 2.0
    """Acceleration of the descent past the planned touchdown: more, and a foot that is
    late by a few hundredths of a second lands with two or three weights."""
    landing_time: Positive[Seconds] = 0.5
    """Longest final part of a swing, in which the sole reaches ``landing_speed``."""
    apex: ProperShare = 0.4
    """Share of the swing at which the sole is highest. An early apex lifts the toes
    over what lies unexpected ahead of the foot."""
    lift_time: NotNegative[Seconds] = 0.04
    """Time after lift-off without horizontal motion: the sole rises before it goes
    ahead, so that its toes do not stub. A tenth of the swing at most."""
    toe_down: NotNegative[RadiansPerMeter] = 0.8
    """Pitch of the toes at the apex per swing height. A climb reduces it, so that the
    toes do not catch the edge."""
    climb_share: ProperShare = 0.5
    """Share of the swing in which the height changes: the first part of a step up, the
    last part of a step down, which keeps the sole off the edge."""
    edge_share: Share = 0.25
    """Share of the swing, at the same end as ``climb_share``, without horizontal motion
    if there is an edge between lift-off and landing."""
    edge_height: Positive[Meters] = 0.04
    """Difference in height from which ``edge_share`` applies in full."""
    heel_down: ProperShare = 0.6
    """Share of the swing in which a heel that left the ground last comes down; then the
    toes rise for a landing on the heel."""
    unhurried: Positive[Seconds] = 0.4
    """Duration T from which a swing has its full height and ``landing_speed``. A
    shorter one rises less, as T², so that the foot needs no larger acceleration, and
    lands faster, as 1/T³, so that a foot behind its reference is not late."""
    lowering_time: Positive[Seconds] = 0.03
    """Time constant with which the height follows when a swing is hastened."""

    def height_share(self, duration: float) -> float:
        """Computes the share of its height that a swing reaches [-]."""
        return min(duration / self.unhurried, 1.0) ** 2

    def touchdown_speed(self, duration: float) -> float:
        """Computes the speed at which a swing lands [m/s]."""
        return self.landing_speed / min(duration / self.unhurried, 1.0) ** 3


class Heading(NamedTuple):
    """Heading of the toes; it may be more than half a turn."""

    angle: float  # [rad]
    rate: float = 0.0  # [rad/s]
    acceleration: float = 0.0  # [rad/s²]


@dataclass(frozen=True)
class FootSwing:
    """State of the swing reference, advanced once per control tick."""

    start: FootPose  # Pose at lift-off
    duration: float  # Duration of the swing [s]
    elapsed: float  # Time since lift-off [s]
    xy: np.ndarray  # Horizontal reference in W, with derivatives, shape (2,)
    xy_velocity: np.ndarray
    xy_acceleration: np.ndarray
    heading: Heading
    pitch: Pitch  # About the toes with the heel up, about the heel with the toes up
    half_length: float  # Distance of toes and heel from the sole's center [m]
    landing_pitch: float  # Pitch at touchdown [rad]
    around: np.ndarray  # Displacement of the way's middle in W [m], shape (2,)
    height_share: float = 1.0  # Of the height that the step demands

    @property
    def remaining(self) -> float:
        """Time to the planned touchdown [s]."""
        return max(self.duration - self.elapsed, 0.0)

    @property
    def progress(self) -> float:
        """Share of the swing that has passed, 0 to 1."""
        return min(self.elapsed / self.duration, 1.0)

    def landing_sooner(self, sooner: float) -> FootSwing:
        """Returns the swing at the same point of its path, landing ``sooner`` [s]."""
        if sooner == 0.0:
            return self
        left = self.remaining - sooner
        duration = left / (1.0 - self.progress)
        return replace(self, duration=duration, elapsed=duration - left)


def begin_swing(
    start: FootPose,
    duration: float,
    half_length: float = 0.0,
    pitch: Pitch = FLAT,
    landing_pitch: float = 0.0,
    around: np.ndarray = STRAIGHT,
) -> FootSwing:
    """Makes a swing that lifts off from ``start`` at rest but for its pitch.

    Args:
        start: Flat pose of the sole at lift-off.
        duration: Of the swing [s].
        half_length: Distance of toes and heel from the sole's center [m]; for a swing
            with a pitch.
        pitch: About the toes at lift-off.
        landing_pitch: Pitch at touchdown, positive with the heel up [rad].
        around: Displacement of the way's middle, around the other leg, in W [m].
    """
    zero, xy = np.zeros(2), start.p_WF[:2].copy()
    return FootSwing(
        start=start,
        duration=duration,
        elapsed=0.0,
        xy=xy,
        xy_velocity=zero,
        xy_acceleration=zero,
        heading=Heading(start.yaw),
        pitch=pitch,
        half_length=half_length,
        landing_pitch=landing_pitch,
        around=around,
    )


def swing_from_the_air(
    sole: FootPose,
    velocity: np.ndarray,
    target: Footstep,
    remaining: float,
    profile: SwingProfile,
) -> tuple[FootSwing, Footstep]:
    """Makes the rest of a swing whose foot is at its apex now, and moves.

    Args:
        sole: Present pose.
        velocity: Horizontal, in W [m/s], shape (2,).
        target: Where the foot goes, on the ground.
        remaining: Time to touchdown [s].
        profile: Shape of the swing.

    Returns:
        The swing, and the step with the height that the foot has.
    """
    duration = remaining / (1.0 - profile.apex)
    p_WF = np.append(sole.p_WF[:2], target.p_WF[2])
    below = replace(target, p_WF=p_WF, yaw=sole.yaw).pose
    passed, share = profile.apex * duration, profile.height_share(duration)
    landing, _, _ = _landing(passed, duration, profile)
    above = float(sole.p_WF[2] - target.p_WF[2])
    swing = replace(
        begin_swing(below, duration),
        elapsed=passed,
        xy_velocity=velocity,
        height_share=share,
    )
    height = landing + max(above - landing, 0.0) / share
    return swing, replace(target, swing_height=height)


def advance_swing(
    swing: FootSwing, target: Footstep, profile: SwingProfile, dt: float
) -> tuple[FootSwing, SoleMotion]:
    """Advances the swing by ``dt`` [s] toward ``target``."""
    elapsed = swing.elapsed + dt
    begin, end = _horizontal_window(swing, target, profile)
    xy, velocity, acceleration = swing.xy, np.zeros(2), np.zeros(2)
    if begin <= elapsed < end:
        since = max(swing.elapsed, begin)
        xy, velocity, acceleration = quintic_step(
            swing.xy,
            swing.xy_velocity,
            swing.xy_acceleration,
            target.p_WF[:2],
            max(end - since, 2.0 * dt),
            elapsed - since,
        )
    moved = replace(
        swing,
        elapsed=elapsed,
        xy=xy,
        xy_velocity=velocity,
        xy_acceleration=acceleration,
        heading=_heading(swing, target, dt),
        pitch=_pitch(swing, profile, dt),
        height_share=_height_share(swing, profile, dt),
    )
    return moved, _reference(moved, target, profile)


def _horizontal_window(
    swing: FootSwing, target: Footstep, profile: SwingProfile
) -> tuple[float, float]:
    """Computes the start and end of the horizontal motion since lift-off [s].

    The foot rises first, on a step up for longer; on a step down it sinks last.
    """
    climb = float(target.p_WF[2] - swing.start.p_WF[2])
    edge = min(abs(climb) / profile.edge_height, 1.0)
    still = profile.edge_share * edge * swing.duration
    lift = min(profile.lift_time, _LONGEST_LIFT * swing.duration)
    if climb > 0.0:
        return max(lift, still), swing.duration
    return lift, swing.duration - still


class Push(NamedTuple):
    """Horizontal acceleration of a foot for a while.

    Attributes:
        duration: [s], positive.
        coefficients: Of 1, t, t², t³, with the time t since its start, in W [m/s²,
            m/s³, ...], shape (4, 2); None for no acceleration.
    """

    duration: float
    coefficients: np.ndarray | None = None


def pushes_ahead(
    swing: FootSwing, target: Footstep, profile: SwingProfile
) -> tuple[Push, ...]:
    """Returns the horizontal acceleration of the rest of the swing to ``target``."""
    begin, end = _horizontal_window(swing, target, profile)
    begin, end = max(begin, swing.elapsed), max(end, swing.elapsed)
    before, moving, after = begin - swing.elapsed, end - begin, swing.duration - end
    push = None
    if moving > _SHORTEST_PUSH:
        p, v, a = swing.xy, swing.xy_velocity, swing.xy_acceleration
        c3, c4, c5 = quintic_coefficients(p, v, a, target.p_WF[:2], moving)
        push = np.array([a, 6.0 * c3, 12.0 * c4, 20.0 * c5])
    pushes = Push(before), Push(moving, push), Push(after)
    return tuple(push for push in pushes if push.duration > _SHORTEST_PUSH)


def _heading(swing: FootSwing, target: Footstep, dt: float) -> Heading:
    """Advances the heading to that of the landing, the shorter way round."""
    goal = swing.heading.angle + wrap_angle(target.yaw - swing.heading.angle)
    if swing.remaining <= dt:
        return Heading(goal)
    return Heading(*quintic_step_of_one(*swing.heading, goal, swing.remaining, dt))


def _pitch(swing: FootSwing, profile: SwingProfile, dt: float) -> Pitch:
    """Advances the pitch about the toes to 0, and then to that of the landing."""
    down, elapsed = profile.heel_down * swing.duration, swing.elapsed
    goal, end = (0.0, down) if elapsed < down else (swing.landing_pitch, swing.duration)
    left = end - elapsed
    if left <= dt or (goal == 0.0 and swing.pitch == FLAT):
        return Pitch(goal)
    return Pitch(*quintic_step_of_one(*swing.pitch, goal, left, dt))


def _height_share(swing: FootSwing, profile: SwingProfile, dt: float) -> float:
    """Advances the share of the height to that of the present duration."""
    goal = profile.height_share(swing.duration)
    if swing.elapsed == 0.0:
        return goal
    return goal + (swing.height_share - goal) * math.exp(-dt / profile.lowering_time)


def _reference(swing: FootSwing, target: Footstep, profile: SwingProfile) -> SoleMotion:
    z, vz, az = _height(swing, target, profile)
    T = swing.duration
    s, ds, dds = quintic_progress(swing.progress)
    tipped, tip_rate, tip_push = rise_and_fall(swing.progress, profile.apex)
    toes = _toe_pitch(swing, target, profile)
    heading, rate, push = swing.heading
    R, by_heading, by_progress = _sole_on_ground(swing.start, target, heading, s)
    b, db, ddb = rise_and_fall(swing.progress, 0.5)
    flat = SoleMotion(
        p_WF=np.array([*(swing.xy + b * swing.around), z]),
        v_WF=np.array([*(swing.xy_velocity + db / T * swing.around), vz]),
        a_WF=np.array([*(swing.xy_acceleration + ddb / T**2 * swing.around), az]),
        R_WF=R,
        # The axes of the rotation hardly move; their rates are neglected.
        w_WF=rate * by_heading + ds / T * by_progress,
        alpha_WF=push * by_heading + dds / T**2 * by_progress,
    )
    toes_down = Pitch(toes * tipped, toes * tip_rate / T, toes * tip_push / T**2)
    motion = flat.pitched(toes_down, 0.0)
    if swing.pitch == FLAT:
        return motion
    on_toes = swing.pitch.angle > 0.0
    return motion.pitched(
        swing.pitch, swing.half_length if on_toes else -swing.half_length
    )


def _sole_on_ground(
    start: FootPose, target: Footstep, heading: float, s: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orientation with a heading [rad] between start and target, without toe pitch.

    The normal goes from one to the other with the progress ``s``, 0 to 1. The angular
    velocities per unit of the heading's rate and of that of ``s`` follow, of shape (3,)
    each.
    """
    start_normal = start.R_WF[:, 2]
    difference = target.normal - start_normal
    along = start_normal + s * difference
    length = math.sqrt(along @ along)
    normal = along / length
    # The rate of the normal, but for a part along the normal that drops out below.
    tilting = difference / length
    R = rotation_with_normal(heading, normal)
    # The turn about the normal follows from x staying above the heading: x points along
    # u = [cos, sin, slope], and only the part of u's rate along y turns x.
    c, si = math.cos(heading), math.sin(heading)
    n, t, y = normal.tolist(), tilting.tolist(), R[:, 1].tolist()
    slope = -(c * n[0] + si * n[1]) / n[2]
    length = math.sqrt(1.0 + slope * slope)
    by_heading = c * y[1] - si * y[0] + (si * n[0] - c * n[1]) / n[2] * y[2]
    by_tilting = -(c * t[0] + si * t[1] + slope * t[2]) / n[2] * y[2]
    return (
        R,
        by_heading / length * normal,
        cross(normal, tilting) + by_tilting / length * normal,
    )


def _toe_pitch(swing: FootSwing, target: Footstep, profile: SwingProfile) -> float:
    """Pitch of the toes at the apex [rad]; none for a climb as high as the swing."""
    climb = max(float(target.p_WF[2] - swing.start.p_WF[2]), 0.0)
    return profile.toe_down * max(target.swing_height - climb, 0.0)


def _height(
    swing: FootSwing, target: Footstep, profile: SwingProfile
) -> tuple[float, float, float]:
    """Height of the sole, its rate and acceleration: a bump, a ramp and a landing.

    The ramp is the climb from the ground here to the ground there. Bump and ramp end
    at rest; the landing makes the sole meet the ground at speed, and so on time.
    """
    T = swing.duration
    z0 = float(swing.start.p_WF[2])
    climb = float(target.p_WF[2]) - z0
    if swing.elapsed >= T:
        late, speed = swing.elapsed - T, profile.touchdown_speed(T)
        a = profile.late_acceleration
        sunk = (speed + 0.5 * a * late) * late
        return z0 + climb - sunk, -speed - a * late, -a
    share = profile.climb_share
    begin = 0.0 if climb > 0.0 else 1.0 - share
    r, dr, ddr = quintic_progress(min(max((swing.progress - begin) / share, 0.0), 1.0))
    b, db, ddb = rise_and_fall(swing.progress, profile.apex)
    above, rate, push = _landing(swing.elapsed, T, profile)
    # The landing's own height counts at the apex.
    at_apex, _, _ = _landing(profile.apex * T, T, profile)
    height = target.swing_height - 0.5 * abs(climb) - at_apex
    # The share c of the height decays to its goal, so that ċ = (goal - c) / τ.
    c, tau = swing.height_share, profile.lowering_time
    dc = (profile.height_share(T) - c) / tau
    db, ddb = db / T, ddb / (T * T)
    takes = share * T
    return (
        z0 + climb * r + height * c * b + above,
        climb * dr / takes + height * (c * db + dc * b) + rate,
        climb * ddr / takes**2
        + height * (c * ddb + 2.0 * dc * db - dc / tau * b)
        + push,
    )


def _landing(
    elapsed: float, T: float, profile: SwingProfile
) -> tuple[float, float, float]:
    """Computes v·τ·u³(1-u) with its first and second derivative in time.

    It ends at 0 with the landing speed v downward; u grows from 0 to 1 during the last
    τ of the swing's duration T [s].
    """
    tau, speed = min(T, profile.landing_time), profile.touchdown_speed(T)
    u = max((elapsed - T) / tau + 1.0, 0.0)
    return (
        speed * tau * u**3 * (1.0 - u),
        speed * u * u * (3.0 - 4.0 * u),
        speed / tau * u * (6.0 - 12.0 * u),
    )
