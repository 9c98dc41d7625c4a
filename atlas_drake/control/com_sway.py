"""Quasi-static motion of the centre of mass from one place of rest to another.

A quintic on a straight line, and the DCM and CoP that belong to it. Decides neither
where to go nor when.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.dcm_plan import DcmReference
from atlas_drake.control.swing_foot import quintic_progress

PEAK_ACCELERATION = 10.0 / math.sqrt(3.0)
"""Of a quintic from rest to rest, over distance per duration squared [-]."""


@dataclass(frozen=True)
class ComSway:
    """The centre of mass moves from rest to rest.

    Attributes:
        start: Horizontal, in W [m], shape (2,).
        end: Likewise.
        duration: [s], positive.
    """

    start: np.ndarray
    end: np.ndarray
    duration: float

    def evaluate(self, time: float, omega: float) -> DcmReference:
        """The reference at ``time`` [s], held beyond either end.

        Args:
            time: Since the beginning [s].
            omega: Natural frequency of the pendulum [1/s].
        """
        T = self.duration
        s, ds, dds = quintic_progress(min(max(time / T, 0.0), 1.0))
        way = self.end - self.start
        com = self.start + s * way
        return DcmReference(
            dcm=com + (ds / (T * omega)) * way,
            cop=com - (dds / (T * omega) ** 2) * way,
        )


def sway_duration(distance: float, max_acceleration: float) -> float:
    """Least duration [s] of a sway over ``distance`` [m] within an acceleration."""
    return math.sqrt(PEAK_ACCELERATION * distance / max_acceleration)
