"""Smooth motion of a point to a goal that may jump.

A critically damped spring pulls the point, with bounded acceleration and speed. The
coordinates of the point may have any meaning and unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.configuration import Configuration, NotNegative, Positive


@dataclass(frozen=True)
class MotionLimits(Configuration):
    """Limits on the motion of a point, in any unit.

    Raises:
        ValueError: If the acceleration is too small to brake from full speed as fast as
            the spring requires, so that the point would overshoot its goal.
    """

    speed: NotNegative
    """Greatest speed [1/s]."""
    acceleration: NotNegative
    """Greatest acceleration [1/s²]."""
    rate: Positive = 4.0
    """Rate of the spring: the distance to the goal shrinks by a factor e in 1/rate
    [1/s]."""

    def __post_init__(self) -> None:
        """Checks that the point can brake."""
        if self.acceleration < self.speed * self.rate / math.e:
            raise ValueError(
                f"an acceleration of {self.acceleration:g} does not stop a speed of "
                f"{self.speed:g} at the rate {self.rate:g}"
            )


@dataclass(frozen=True)
class Motion:
    """Motion of a point with any number of coordinates.

    Attributes:
        position: Position, shape (k,).
        velocity: Velocity, shape (k,).
        acceleration: Acceleration during the last tick, shape (k,).
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def towards(self, goal: np.ndarray, limits: MotionLimits, dt: float) -> Motion:
        """Advances by ``dt`` [s]; from rest the path to ``goal`` is a straight line."""
        w = limits.rate
        wanted = w * w * (goal - self.position) - 2.0 * w * self.velocity
        pull = _bounded(wanted, limits.acceleration)
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
