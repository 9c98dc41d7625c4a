"""Motion of a foot that is lifted straight up, moved across, and lowered straight down.

The quasi-static counterpart of ``swing_foot``: planned once at lift-off, because the
landing pose does not change. Each part is the same minimum-jerk quintic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.control.feet.curves import quintic_progress, rise_and_fall
from atlas_drake.control.feet.sole_motion import SoleMotion
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import rotation_about, rotation_vector
from atlas_drake.units import Meters, MetersPerRadian, MetersPerSecond, Seconds

PEAK_SPEED = 1.875
"""Peak speed of the quintic from rest to rest, over distance per duration: a property
of the curve [-]."""


@dataclass(frozen=True)
class SwingPathProfile(Configuration):
    """Parameters of the swing that are the same for all steps of STEP."""

    press_depth: NotNegative[Meters] = 0.005
    """Depth of the landing goal below the ground, so that the foot meets the ground."""
    late_descent: Positive[MetersPerSecond] = 0.10
    """Descent speed of a foot that has not met the ground at the planned touchdown."""
    deepest: NotNegative[Meters] = 0.06
    """Depth below the expected ground to which the foot descends in search of it."""
    turn_radius: Positive[MetersPerRadian] = 0.25
    """Assumed distance that a point of a turning foot moves per angle."""
    shortest_part: Positive[Seconds] = 0.15
    """Least duration of each phase: lifting, moving and lowering."""


@dataclass(frozen=True)
class SwingPath:
    """Path of a sole from lift-off to landing."""

    start: FootPose  # Pose at lift-off; the heel may be up
    flat: np.ndarray  # Orientation of the sole after lifting
    goal: FootPose  # Pose on landing
    top: float  # Height in W at which the move across starts and ends [m]
    arc: float  # Rise of the foot above ``top`` midway [m]
    lift: float  # Duration of lifting [s]
    move: float  # Duration of moving across [s]
    lower: float  # Duration of lowering [s]
    profile: SwingPathProfile  # Parameters that are the same for all steps

    @property
    def duration(self) -> float:
        """Time from lift-off to the planned touchdown [s]."""
        return self.lift + self.move + self.lower

    def is_lowering(self, time: float) -> bool:
        """Returns True while the foot is being lowered at ``time`` [s] or later."""
        return time >= self.lift + self.move

    def has_missed(self, time: float) -> bool:
        """Returns True once the foot has reached the greatest search depth."""
        return self._late(time) * self.profile.late_descent >= self.profile.deepest

    def evaluate(self, time: float) -> SoleMotion:
        """Computes the reference at ``time`` [s] since lift-off."""
        start, goal = self.start, self.goal
        z = np.array([0.0, 0.0, 1.0])
        if time < self.lift:
            p, v, a = _along(time, self.lift, (self.top - start.p_WF[2]) * z)
            turning = _turning(time, self.lift, start.R_WF, self.flat)
            return SoleMotion(start.p_WF + p, v, a, *turning)
        if not self.is_lowering(time):
            return self._across(time - self.lift)
        over = np.array([goal.p_WF[0], goal.p_WF[1], self.top])
        down = goal.p_WF[2] - self.profile.press_depth - self.top
        late = self._late(time)
        if late == 0.0:
            p, v, a = _along(time - self.lift - self.move, self.lower, down * z)
            return _straight(over + p, v, a, goal.R_WF)
        depth = min(self.profile.late_descent * late, self.profile.deepest)
        speed = 0.0 if self.has_missed(time) else self.profile.late_descent
        return _straight(over + (down - depth) * z, -speed * z, 0.0 * z, goal.R_WF)

    def _late(self, time: float) -> float:
        return max(time - self.duration, 0.0)

    def _across(self, time: float) -> SoleMotion:
        start, goal = self.start, self.goal
        way = goal.p_WF - start.p_WF
        way = np.array([way[0], way[1], 0.0])
        p, v, a = _along(time, self.move, way)
        rise, rate, acceleration = rise_and_fall(time / self.move, 0.5)
        p[2] += self.top + self.arc * rise
        v[2] += self.arc * rate / self.move
        a[2] += self.arc * acceleration / self.move**2
        p[:2] += start.p_WF[:2]
        turning = _turning(time, self.move, self.flat, goal.R_WF)
        return SoleMotion(p, v, a, *turning)


def plan_swing_path(
    start: FootPose,
    home: FootPose,
    goal: FootPose,
    lift_height: float,
    swing_height: float,
    duration: float,
    max_speed: float,
    profile: SwingPathProfile,
) -> SwingPath:
    """Plans a swing that takes ``duration`` [s], or longer within ``max_speed`` [m/s].

    ``home`` is the flat pose before the heel rose; ``lift_height`` [m] counts from the
    higher of ``home`` and ``goal``, ``swing_height`` [m] from the lifted height.
    """
    top = max(home.p_WF[2], goal.p_WF[2], start.p_WF[2] - lift_height) + lift_height
    way = math.hypot(*(goal.p_WF - start.p_WF)[:2])
    turn = rotation_vector(home.R_WF.T @ goal.R_WF)
    across = math.hypot(
        way, profile.turn_radius * math.sqrt(turn @ turn), 2.0 * swing_height
    )
    distances = (
        float(top - start.p_WF[2]),
        across,
        float(top - goal.p_WF[2]) + profile.press_depth,
    )
    parts = [
        max(PEAK_SPEED * distance / max_speed, profile.shortest_part)
        for distance in distances
    ]
    stretch = max(duration / sum(parts), 1.0)
    lift, move, lower = (part * stretch for part in parts)
    return SwingPath(
        start, home.R_WF, goal, top, swing_height, lift, move, lower, profile
    )


def _along(
    time: float, duration: float, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement along ``way``, velocity and acceleration, from rest to rest."""
    s, ds, dds = quintic_progress(time / duration)
    return s * way, ds / duration * way, dds / duration**2 * way


def _turning(
    time: float, duration: float, R_WA: np.ndarray, R_WB: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orientation, angular velocity and acceleration of a turn from A to B."""
    turn = rotation_vector(R_WA.T @ R_WB)
    angle, rate, acceleration = _along(time, duration, turn)
    return R_WA @ rotation_about(angle), R_WA @ rate, R_WA @ acceleration


def _straight(p: np.ndarray, v: np.ndarray, a: np.ndarray, R: np.ndarray) -> SoleMotion:
    still = np.zeros(3)
    return SoleMotion(p_WF=p, v_WF=v, a_WF=a, R_WF=R, w_WF=still, alpha_WF=still)
