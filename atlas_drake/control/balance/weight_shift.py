"""Quasi-static weight shift: the center of mass goes from one place of rest to another.

A quintic on a straight line, and the DCM and CoP that belong to it. Decides neither
where to go nor when.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.swing_foot import quintic_progress

PEAK_ACCELERATION = 10.0 / math.sqrt(3.0)
"""Of a quintic from rest to rest, over distance per duration squared [-]."""
CHECKED = np.linspace(0.0, 1.0, 11)
"""Shares of its duration at which the CoP of a weight shift is checked [-]."""
START_INSIDE = 2.0
"""How far inside the support a weight shift begins, over how far its CoP stays inside
[-]: room for the push that the beginning takes."""
LONGER = 1.15
"""Ratio of one duration that is tried to the one before [-]."""
TRIES = 16
"""Most durations that are tried."""


@dataclass(frozen=True)
class WeightShift:
    """The center of mass goes from rest to rest; all horizontal in W, shape (2,).

    Attributes:
        start: Where it begins [m].
        end: Where it comes to rest [m].
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
        com, velocity, acceleration = self.motion(time)
        return DcmReference(
            dcm=com + velocity / omega, cop=com - acceleration / (omega * omega)
        )

    def motion(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and acceleration at ``time`` [s]."""
        way, duration = self.end - self.start, self.duration
        s, ds, dds = quintic_progress(min(max(time / duration, 0.0), 1.0))
        return (
            self.start + s * way,
            ds / duration * way,
            dds / (duration * duration) * way,
        )

    def cop_outside(self, support: SupportPolygon, omega: float) -> float:
        """Computes how far the CoP leaves ``support`` at most [m]; negative inside.

        Args:
            support: Where the CoP may lie.
            omega: Natural frequency of the pendulum [1/s].
        """
        return max(
            support.distance_outside(self.evaluate(share * self.duration, omega).cop)
            for share in CHECKED
        )


def sway_duration(distance: float, max_acceleration: float) -> float:
    """Least duration [s] of a sway over ``distance`` [m] within an acceleration."""
    return math.sqrt(PEAK_ACCELERATION * distance / max_acceleration)


def plan_weight_shift(
    dcm: np.ndarray,
    end: np.ndarray,
    least_duration: float,
    support: SupportPolygon,
    inside: float,
    omega: float,
) -> WeightShift:
    """Plans the shortest weight shift that the feet can bring about.

    The weight shift begins at rest at the DCM of the robot, where the center of mass
    would come to rest by itself: the reference of the DCM is then continuous, whatever
    the velocity, and never leads farther outward. Where the DCM is not START_INSIDE
    times ``inside`` within the support, the weight shift begins nearer to ``end``
    instead, at the first tenth of the way that is; the reference of the DCM then jumps.

    Args:
        dcm: Of the robot, horizontal in W [m], shape (2,).
        end: Where the center of mass shall rest [m], shape (2,).
        least_duration: [s]
        support: Where the CoP may lie.
        inside: How far inside it shall stay, for feedback to have room [m].
        omega: Natural frequency of the pendulum [1/s].

    Returns:
        The weight shift, in the shortest of the durations tried that keeps its CoP
        ``inside`` the support. If none does, the longest of them, which is
        LONGER ** (TRIES - 1) = 8.1 times ``least_duration``, and the CoP does not stay
        ``inside``; nothing else tells of it.
    """
    start = _pulled_inside(dcm, end, support, START_INSIDE * inside)
    for attempt in range(TRIES):
        sway = WeightShift(start, end, least_duration * LONGER**attempt)
        if sway.cop_outside(support, omega) <= -inside:
            break
    return sway


def _pulled_inside(
    dcm: np.ndarray, end: np.ndarray, support: SupportPolygon, inside: float
) -> np.ndarray:
    """The first tenth of the way from ``dcm`` to ``end`` that lies so far inside.

    ``dcm`` itself if it does; ``end`` if none of them does.
    """
    for share in CHECKED:
        point = dcm + share * (end - dcm)
        if support.distance_outside(point) <= -inside:
            break
    return point
