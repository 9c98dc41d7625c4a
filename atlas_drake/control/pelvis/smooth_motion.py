"""A point that is moved to a goal without jerks, wherever the goal jumps.

A critically damped spring pulls it, at bounded acceleration and speed. Knows
nothing of what the point stands for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.bounds import Positive


@dataclass(frozen=True)
class MotionLimits:
    """How fast a point moves, whatever its unit.

    Raises:
        ValueError: If the acceleration is too small to brake from full speed as the
            spring wants to, which would let the point run over its goal.
    """

    speed: float
    """[1/s]"""
    acceleration: float
    """[1/s²]"""
    rate: Positive = 4.0
    """Of the spring: what is left of the way shrinks by e in 1/rate [1/s]."""

    def __post_init__(self) -> None:
        """Checks that the point can brake."""
        if self.acceleration < self.speed * self.rate / math.e:
            raise ValueError(
                f"an acceleration of {self.acceleration:g} does not stop a speed of "
                f"{self.speed:g} at the rate {self.rate:g}"
            )


@dataclass(frozen=True)
class Motion:
    """A point on its way; any number of coordinates.

    Attributes:
        position: Shape (k,).
        velocity: Shape (k,).
        acceleration: Of the last tick, shape (k,).
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def towards(self, goal: np.ndarray, limits: MotionLimits, dt: float) -> Motion:
        """Moved on by ``dt`` [s]; from rest it goes to ``goal`` in a straight line."""
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
    """A motion that begins at ``position``, by default at rest."""
    still = np.zeros_like(position)
    return Motion(position, still if velocity is None else velocity, still)


def _bounded(vector: np.ndarray, longest: float) -> np.ndarray:
    length = math.sqrt(vector @ vector)
    return vector if length <= longest else vector * (longest / length)
