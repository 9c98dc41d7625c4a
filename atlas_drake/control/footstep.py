"""Footsteps as geometry: where a sole shall land, and what the legs can reach.

A foot's pose is that of its sole frame: the centre of the sole on its bottom plane,
x to the toes, z along the sole's normal. No messages, no timing of a gait.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from atlas_drake.control.rotations import (
    rotation_with_normal,
    rotation_z,
    wrap_angle,
    yaw_of,
)

LEFT, RIGHT = 0, 1


@dataclass(frozen=True)
class FootPose:
    """Where a sole is.

    Attributes:
        p_WF: Centre of the sole in W [m], shape (3,).
        R_WF: Orientation, shape (3, 3).
    """

    p_WF: np.ndarray
    R_WF: np.ndarray

    @property
    def yaw(self) -> float:
        """Heading of the toes [rad]."""
        return yaw_of(self.R_WF)


@dataclass(frozen=True)
class Footstep:
    """One step to take.

    Attributes:
        index: The caller's step index.
        foot: LEFT or RIGHT.
        p_WF: Where the sole's centre lands in W [m], shape (3,).
        yaw: Heading of the toes on landing [rad].
        duration: From one touchdown to the next [s].
        swing_height: Apex of the swing above the higher of its ends [m].
        normal: Of the ground there, a unit vector in W, shape (3,).
    """

    index: int
    foot: int
    p_WF: np.ndarray
    yaw: float
    duration: float
    swing_height: float
    normal: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    @property
    def pose(self) -> FootPose:
        """The landing pose."""
        return FootPose(self.p_WF, rotation_with_normal(self.yaw, self.normal))


@dataclass(frozen=True)
class StepLimits:
    """What one step can be, relative to the foot that stays on the ground.

    Lateral distances count away from the stance foot, turns likewise: a left foot
    turns its toes to the left.
    """

    forward: float = 0.42
    """[m]"""
    backward: float = 0.32
    """[m]"""
    min_width: float = 0.18
    """Nearest the feet come to each other sideways, centre to centre [m]."""
    max_width: float = 0.50
    """[m]"""
    rise: float = 0.10
    """Largest step up or down [m]."""
    tilt: float = 0.0
    """Steepest ground, from the level [rad]."""
    toe_out: float = 0.5
    """[rad]"""
    toe_in: float = 0.25
    """[rad]"""
    min_duration: float = 0.60
    """[s]"""
    max_duration: float = 3.0
    """[s]"""
    min_swing_height: float = 0.03
    """[m]"""
    max_swing_height: float = 0.30
    """[m]"""


def outward(foot: int) -> float:
    """Sign of y that leads away from the other foot."""
    return 1.0 if foot == LEFT else -1.0


def saturate(step: Footstep, stance: FootPose, limits: StepLimits) -> Footstep:
    """The step nearest to ``step`` that the robot can take from ``stance``.

    Also lays the step on the level of the stance foot within ``limits.rise``, and its
    ground within ``limits.tilt`` of the level.
    """
    R_WS = rotation_z(stance.yaw)
    sign = outward(step.foot)
    p_SF = R_WS.T @ (step.p_WF - stance.p_WF)
    reach = np.array(
        [
            _clip(p_SF[0], -limits.backward, limits.forward),
            sign * _clip(sign * p_SF[1], limits.min_width, limits.max_width),
            _clip(p_SF[2], -limits.rise, limits.rise),
        ]
    )
    turn = sign * _clip(
        sign * wrap_angle(step.yaw - stance.yaw), -limits.toe_in, limits.toe_out
    )
    return replace(
        step,
        p_WF=stance.p_WF + R_WS @ reach,
        yaw=stance.yaw + turn,
        normal=_within_tilt(step.normal, limits.tilt),
        duration=_clip(step.duration, limits.min_duration, limits.max_duration),
        swing_height=_clip(
            step.swing_height, limits.min_swing_height, limits.max_swing_height
        ),
    )


def _within_tilt(normal: np.ndarray, tilt: float) -> np.ndarray:
    """The unit vector nearest to ``normal`` within ``tilt`` [rad] of the vertical."""
    horizontal = math.hypot(normal[0], normal[1])
    if math.atan2(horizontal, normal[2]) <= tilt:
        return normal
    if horizontal == 0.0:
        return np.array([0.0, 0.0, 1.0])
    across = math.sin(tilt) / horizontal
    return np.array([across * normal[0], across * normal[1], math.cos(tilt)])


def _clip(value: float, low: float, high: float) -> float:
    return float(min(max(value, low), high))


def landing_error(step: Footstep, landed: FootPose) -> float:
    """Horizontal distance between where a step was sent and where it landed [m]."""
    return math.hypot(
        landed.p_WF[0] - step.p_WF[0],
        landed.p_WF[1] - step.p_WF[1],
    )
