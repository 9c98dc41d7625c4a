"""Reference motion of the divergent component of motion (DCM) over future steps.

The linear inverted pendulum with a piecewise-linear center of pressure (CoP),
solved backward in time from the point where the robot comes to rest. After Englsberger,
Ott, Albu-Schäffer, "Three-dimensional bipedal walking control based on divergent
component of motion", T-RO 2015.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from atlas_drake.frozen import Frozen


@dataclass(frozen=True)
class CopSegment:
    """The CoP moves on a straight line at constant speed.

    Attributes:
        duration: Time that the motion takes [s], positive.
        start: CoP at the start, horizontal, in W [m], shape (2,).
        end: CoP at the end [m], shape (2,).
    """

    duration: float
    start: np.ndarray
    end: np.ndarray


@dataclass(frozen=True)
class DcmReference:
    """The plan at one instant: horizontal positions in W [m], shape (2,)."""

    dcm: np.ndarray
    cop: np.ndarray


class DcmPlan(Frozen):
    """A bounded DCM trajectory that ends at rest over the last segment's end.

    Attributes:
        omega: Natural frequency of the pendulum [1/s].
        segments: Segments of the CoP, in order of time.
    """

    def __init__(self, segments: Sequence[CopSegment], omega: float):
        """Solves the plan.

        Args:
            segments: One or more segments in order of time; the first starts at time 0.
            omega: Natural frequency of the pendulum √(g/z) [1/s].
        """
        self.omega = omega
        self.segments = tuple(segments)
        self._ends = list(accumulate(segment.duration for segment in segments))
        finals = [np.asarray(segments[-1].end, dtype=float)]
        for segment in reversed(self.segments):
            finals.append(_evaluate(segment, finals[-1], omega, 0.0).dcm)
        self._finals = tuple(reversed(finals[:-1]))

    @property
    def duration(self) -> float:
        """Time of the last segment's end [s]."""
        return self._ends[-1]

    def evaluate(self, time: float) -> DcmReference:
        """Computes the reference at ``time`` [s]; constant beyond the plan's ends."""
        time = min(max(time, 0.0), self.duration)
        index = min(bisect_right(self._ends, time), len(self.segments) - 1)
        segment = self.segments[index]
        into = time - (self._ends[index] - segment.duration)
        return _evaluate(segment, self._finals[index], self.omega, into)


def _evaluate(
    segment: CopSegment, final: np.ndarray, omega: float, into: float
) -> DcmReference:
    """Computes the reference within a segment that ends with the DCM at ``final``.

    With the CoP at p = p₀ + ṗ·t the DCM is ξ = p + ṗ/ω + e^{ω(t-T)}·(ξ_T - p_T - ṗ/ω).
    """
    decay = math.exp(omega * (into - segment.duration))
    passed, lead = into / segment.duration, 1.0 / (omega * segment.duration)
    cop = []
    dcm = []
    for start, end, last in zip(
        segment.start.tolist(), segment.end.tolist(), final.tolist(), strict=True
    ):
        way = end - start
        cop.append(start + way * passed)
        ahead = way * lead
        dcm.append(cop[-1] + ahead + decay * (last - end - ahead))
    return DcmReference(np.array(dcm), np.array(cop))
