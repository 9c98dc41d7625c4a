"""Quasi-static weight shift: the center of mass moves between two places of rest.

The motion is the minimum-jerk quintic on a straight line (Flash, Hogan, "The
coordination of arm movements", Journal of Neuroscience 1985), with the DCM and CoP that
result from it for the linear inverted pendulum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.support_polygon import SupportPolygon

PEAK_ACCELERATION = 10.0 / math.sqrt(3.0)
"""Peak acceleration of the quintic from rest to rest, over distance per duration
squared: a property of the curve [-]."""
CHECKED = np.linspace(0.0, 1.0, 11)
"""Shares of its duration at which the CoP of a weight shift is checked [-]. Numerical,
like LONGER and TRIES: the resolution of a search."""
START_INSIDE = 2.0
"""Margin to the edge of the support at the start of a weight shift, over the margin
that its CoP keeps, which is the setting [-]: the initial acceleration moves the CoP
outward."""
LONGER = 1.15
"""Ratio of each tried duration to the one tried before [-]."""
TRIES = 16
"""Greatest number of durations that are tried."""


@dataclass(frozen=True)
class WeightShift:
    """Motion of the center of mass from rest to rest, horizontal in W, shape (2,)."""

    start: np.ndarray  # Start of the motion [m]
    end: np.ndarray  # Place where the center of mass comes to rest [m]
    duration: float  # Time that the motion takes [s], positive

    def evaluate(self, time: float, omega: float) -> DcmReference:
        """Computes the reference; it is constant before and after the motion."""
        com, velocity, acceleration = self.motion(time)
        return DcmReference(
            dcm=com + velocity / omega, cop=com - acceleration / (omega * omega)
        )

    def motion(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Computes position, velocity and acceleration of the CoM at ``time`` [s]."""
        way, duration = self.end - self.start, self.duration
        s, ds, dds = quintic_progress(min(max(time / duration, 0.0), 1.0))
        return (
            self.start + s * way,
            ds / duration * way,
            dds / (duration * duration) * way,
        )

    def cop_outside(self, support: SupportPolygon, omega: float) -> float:
        """Computes how far the CoP leaves ``support`` at most [m]; negative inside."""
        return max(
            support.distance_outside(self.evaluate(share * self.duration, omega).cop)
            for share in CHECKED
        )


def sway_duration(distance: float, max_acceleration: float) -> float:
    """Computes the least duration [s] of a weight shift over ``distance`` [m]."""
    return math.sqrt(PEAK_ACCELERATION * distance / max_acceleration)


def plan_weight_shift(
    dcm: np.ndarray,
    end: np.ndarray,
    min_duration: float,
    support: SupportPolygon,
    inside: float,
    omega: float,
) -> WeightShift:
    """Plans the shortest weight shift that the feet can bring about.

    The weight shift starts at rest at the DCM of the robot, where the center of mass
    would come to rest by itself: the reference of the DCM is then continuous for any
    velocity, and never leads farther outward. If the DCM is less than START_INSIDE
    times ``inside`` within the support, the way to ``end`` is searched in steps of a
    tenth, and the weight shift starts at the first point that is far enough inside; the
    reference of the DCM then jumps. The CoP stays ``inside`` [m] the support, unless
    the longest duration tried, 8.1 times ``min_duration``, is too short.
    """
    start = _pulled_inside(dcm, end, support, START_INSIDE * inside)
    for attempt in range(TRIES):
        sway = WeightShift(start, end, min_duration * LONGER**attempt)
        if sway.cop_outside(support, omega) <= -inside:
            break
    return sway


def _pulled_inside(
    dcm: np.ndarray, end: np.ndarray, support: SupportPolygon, inside: float
) -> np.ndarray:
    """Finds the first tenth of the way from ``dcm`` to ``end`` inside the margin.

    Returns ``dcm`` itself if it is inside the margin, ``end`` if no point is.
    """
    for share in CHECKED:
        point = dcm + share * (end - dcm)
        if support.distance_outside(point) <= -inside:
            break
    return point
