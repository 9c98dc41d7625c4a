"""Quasi-static motion of the centre of mass from one place of rest to another.

A quintic on a straight line, and the DCM and CoP that belong to it. Decides neither
where to go nor when.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.dcm_plan import DcmReference
from atlas_drake.control.swing_foot import quintic_step

PEAK_ACCELERATION = 10.0 / math.sqrt(3.0)
"""Of a quintic from rest to rest, over distance per duration squared [-]."""


@dataclass(frozen=True)
class ComSway:
    """The centre of mass comes to rest over ``end``; all horizontal in W, shape (2,).

    Attributes:
        start: Where it begins [m].
        velocity: With which it begins [m/s].
        acceleration: Likewise [m/s²].
        end: Where it comes to rest [m].
        duration: [s], positive.
    """

    start: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    end: np.ndarray
    duration: float

    def evaluate(self, time: float, omega: float) -> DcmReference:
        """The reference at ``time`` [s], held beyond either end.

        Args:
            time: Since the beginning [s].
            omega: Natural frequency of the pendulum [1/s].
        """
        com, velocity, acceleration = self.motion(time)
        return DcmReference(
            dcm=com + velocity / omega, cop=com - acceleration / (omega * omega)
        )

    def motion(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and acceleration at ``time`` [s]."""
        return quintic_step(
            self.start,
            self.velocity,
            self.acceleration,
            self.end,
            self.duration,
            min(max(time, 0.0), self.duration),
        )


def sway_from_rest(start: np.ndarray, end: np.ndarray, duration: float) -> ComSway:
    """A sway that begins at rest."""
    return ComSway(start, np.zeros(2), np.zeros(2), end, duration)


def sway_duration(distance: float, max_acceleration: float) -> float:
    """Least duration [s] of a sway over ``distance`` [m] within an acceleration."""
    return math.sqrt(PEAK_ACCELERATION * distance / max_acceleration)
