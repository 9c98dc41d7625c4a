"""Poses of pelvis and center of mass relative to two feet on the ground.

This module defines the coordinates of a pose and their motion. Feasibility of a pose is
in ``pelvis_reach``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Unit

from atlas_drake.config import (
    Configuration,
    LeastGreatest,
    NotNegative,
    Positive,
    Range,
)
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import mean_yaw, orientation, tilt_of, wrap_angle, yaw_of
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import Meters, PerSecond, Radians

# ``unit`` is the unit of the field that holds the limits.
SpeedOfPoint = Annotated[float, Unit("unit/s")]
AccelerationOfPoint = Annotated[float, Unit("unit/s²")]


@dataclass(frozen=True)
class MotionLimits(Configuration):
    """Limits on the motion of a point, in the unit of its coordinates."""

    speed: NotNegative[SpeedOfPoint]
    """Greatest speed."""
    acceleration: NotNegative[AccelerationOfPoint]
    """Greatest acceleration."""
    rate: Positive[PerSecond] = 4.0
    """Rate of the spring: the distance to the goal shrinks by a factor e in 1/rate."""

    def __post_init__(self) -> None:
        """Checks that the point can brake."""
        if self.acceleration < self.speed * self.rate / math.e:
            raise ValueError(
                f"an acceleration of {self.acceleration:g} does not stop a speed of "
                f"{self.speed:g} at the rate {self.rate:g}"
            )


@dataclass(frozen=True)
class Motion:
    """Motion of a point with any number of coordinates."""

    position: np.ndarray  # Position, shape (k,)
    velocity: np.ndarray  # Velocity, shape (k,)
    acceleration: np.ndarray  # Acceleration during the last tick, shape (k,)

    def towards(self, goal: np.ndarray, limits: MotionLimits, dt: float) -> Motion:
        """Advances by ``dt`` [s]; from rest the path to ``goal`` is a straight line."""
        w = limits.rate
        desired = w * w * (goal - self.position) - 2.0 * w * self.velocity
        pull = _bounded(desired, limits.acceleration)
        velocity = _bounded(self.velocity + pull * dt, limits.speed)
        return Motion(
            position=self.position + velocity * dt,
            velocity=velocity,
            acceleration=(velocity - self.velocity) / dt,
        )


def at_rest(position: np.ndarray, velocity: np.ndarray | None = None) -> Motion:
    """Makes a motion that starts at ``position``, by default at rest."""
    still = np.zeros_like(position)
    return Motion(position, still if velocity is None else velocity, still)


def _bounded(vector: np.ndarray, longest: float) -> np.ndarray:
    length = math.sqrt(vector @ vector)
    return vector if length <= longest else vector * (longest / length)


class PelvisPose(NamedTuple):
    """A pose of pelvis and center of mass relative to a stance.

    Attributes:
        height: Height of the pelvis' origin above the mean of the soles [m].
        yaw: Yaw of the pelvis from the mean heading of the feet, to the left [rad].
        pitch: Pitch of the pelvis, forward and down [rad].
        roll: Roll of the pelvis, to the right [rad].
        com_v0: Center of mass from the middle of the soles along the line from the
            right to the left sole [m].
        com_v1: Center of mass across that line, forward for feet side by side [m].
    """

    height: float
    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    com_v0: float = 0.0
    com_v1: float = 0.0


@dataclass(frozen=True, kw_only=True)
class PelvisRange(Configuration):
    """Range of pelvis poses for MANIPULATE.

    The limits of legs, motors and feet are computed for each pose; these ranges are the
    other limits. Each is a least and a greatest value.
    """

    height: Annotated[Range, Unit("m")] = LeastGreatest(-0.36, 0.04)
    """Height of the pelvis' origin above that in the stand-prep pose."""
    yaw: Annotated[Range, Unit("rad")] = LeastGreatest(-0.6, 0.6)
    """Yaw of the pelvis from the mean heading of the feet, to the left."""
    pitch: Annotated[Range, Unit("rad")] = LeastGreatest(-0.3, 0.5)
    """Pitch of the pelvis, forward and down."""
    roll: Annotated[Range, Unit("rad")] = LeastGreatest(-0.3, 0.3)
    """Roll of the pelvis, to the right."""
    com: Annotated[Range, Unit("m")] = LeastGreatest(-0.5, 0.5)
    """Offset of the center of mass along either axis; the support polygon limits it
    further."""

    def clamp(self, goal: PelvisPose, upright: float) -> PelvisPose:
        """Returns the pose within the range; ``upright``: height in stand-prep [m]."""
        low, high = self.height
        bounds = (
            (upright + low, upright + high),
            self.yaw,
            self.pitch,
            self.roll,
            self.com,
            self.com,
        )
        return PelvisPose(
            *(
                min(max(x, low), high)
                for x, (low, high) in zip(goal, bounds, strict=True)
            )
        )


@dataclass(frozen=True)
class Stance:
    """Both feet on the ground."""

    feet: tuple[FootPose, FootPose]  # Left and right sole
    support: SupportPolygon  # Region in which the CoP may lie on both soles
    middle: np.ndarray  # Middle between the soles in W [m], shape (3,)
    yaw: float  # Mean heading of the soles [rad]
    along: np.ndarray  # Unit vector from the right to the left sole, shape (2,)
    across: np.ndarray  # ``along`` turned to the right by a quarter turn, shape (2,)

    def com(self, pose: PelvisPose) -> np.ndarray:
        """Computes the CoM of ``pose``, horizontal in W [m], shape (2,)."""
        offset = pose.com_v0 * self.along + pose.com_v1 * self.across
        return self.middle[:2] + offset

    def R_WP(self, pose: PelvisPose) -> np.ndarray:
        """Computes the orientation of the pelvis in ``pose``."""
        return orientation(self.yaw + pose.yaw, np.array([pose.roll, pose.pitch]))

    def measure(self, terms: WholeBodyTerms) -> PelvisPose:
        """Computes the present pose of the robot."""
        roll, pitch = tilt_of(terms.R_WP)
        return self.pose_of(
            terms.p_WP[2], yaw_of(terms.R_WP), pitch, roll, terms.com[:2]
        )

    def pose_of(
        self, z: float, yaw: float, pitch: float, roll: float, com: np.ndarray
    ) -> PelvisPose:
        """Makes the pose from the pelvis' height and angles and the CoM in W."""
        offset = com - self.middle[:2]
        return PelvisPose(
            height=float(z - self.middle[2]),
            yaw=wrap_angle(yaw - self.yaw),
            pitch=float(pitch),
            roll=float(roll),
            com_v0=float(offset @ self.along),
            com_v1=float(offset @ self.across),
        )


def make_stance(left: FootPose, right: FootPose, support: SupportPolygon) -> Stance:
    """Makes the stance on two feet."""
    between = left.p_WF[:2] - right.p_WF[:2]
    along = between / np.hypot(*between)
    return Stance(
        feet=(left, right),
        support=support,
        middle=0.5 * (left.p_WF + right.p_WF),
        yaw=mean_yaw(left.yaw, right.yaw),
        along=along,
        across=np.array([along[1], -along[0]]),
    )


@dataclass(frozen=True)
class PelvisRates(Configuration):
    """Limits on the motion of pelvis and center of mass."""

    height: Annotated[MotionLimits, Unit("m")] = field(
        default_factory=lambda: MotionLimits(speed=0.12, acceleration=0.4)
    )
    """Height of the pelvis."""
    turn: Annotated[MotionLimits, Unit("rad")] = field(
        default_factory=lambda: MotionLimits(speed=0.4, acceleration=1.2)
    )
    """Yaw, pitch and roll of the pelvis."""
    com: Annotated[MotionLimits, Unit("m")] = field(
        default_factory=lambda: MotionLimits(speed=0.08, acceleration=0.25)
    )
    """Horizontal position of the center of mass."""


@dataclass(frozen=True)
class PelvisLead(Configuration):
    """Greatest lead of the reference over a robot that does not follow.

    The robot does not follow when a user holds the legs, or during a push. The limits
    are far beyond the lag of a free robot. The center of mass has no such limit: a
    reference that yields to the center of mass would not balance the robot.
    """

    height: NotNegative[Meters] = 0.06
    """Lead in height."""
    turn: NotNegative[Radians] = 0.25
    """Lead in yaw, pitch and roll."""


@dataclass(frozen=True)
class PelvisMotion:
    """The moving reference. It is kept in W, so that it stays when a sole slips."""

    height: Motion  # Height of the pelvis' origin, shape (1,) [m]
    turn: Motion  # Yaw, pitch and roll of the pelvis, shape (3,) [rad]
    com: Motion  # Horizontal position of the center of mass, shape (2,) [m]

    def towards(
        self, goal: PelvisPose, stance: Stance, rates: PelvisRates, dt: float
    ) -> PelvisMotion:
        """Advances the reference toward ``goal`` by ``dt`` [s]."""
        yaw = self.turn.position[0]
        ahead = wrap_angle(stance.yaw + goal.yaw - yaw)
        turn = np.array([yaw + ahead, goal.pitch, goal.roll])
        height = np.array([stance.middle[2] + goal.height])
        return PelvisMotion(
            height=self.height.towards(height, rates.height, dt),
            turn=self.turn.towards(turn, rates.turn, dt),
            com=self.com.towards(stance.com(goal), rates.com, dt),
        )

    def held_near(self, terms: WholeBodyTerms, lead: PelvisLead) -> PelvisMotion:
        """Limits the distance between reference and robot to ``lead``."""
        roll, pitch = tilt_of(terms.R_WP)
        yaw = self.turn.position[0] + wrap_angle(
            yaw_of(terms.R_WP) - self.turn.position[0]
        )
        return PelvisMotion(
            height=_held_near(self.height, terms.p_WP[2:], lead.height),
            turn=_held_near(self.turn, np.array([yaw, pitch, roll]), lead.turn),
            com=self.com,
        )

    def pose(self, stance: Stance) -> PelvisPose:
        """Returns the reference relative to ``stance``."""
        yaw, pitch, roll = self.turn.position
        return stance.pose_of(
            self.height.position[0], yaw, pitch, roll, self.com.position
        )


def _held_near(motion: Motion, measured: np.ndarray, lead: float) -> Motion:
    """Returns the motion, or one at rest at the limit if it is beyond ``lead``."""
    ahead = motion.position - measured
    if np.abs(ahead).max() <= lead:
        return motion
    held = measured + np.minimum(np.maximum(ahead, -lead), lead)
    return at_rest(held)
