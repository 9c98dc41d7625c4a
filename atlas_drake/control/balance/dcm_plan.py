"""Reference motion of the divergent component of motion (DCM) over future steps.

The linear inverted pendulum with a piecewise-linear center of pressure (CoP),
solved backward in time from the point where the robot comes to rest. After Englsberger,
Ott, Albu-Schäffer, "Three-dimensional bipedal walking control based on divergent
component of motion", T-RO 2015. The pendulum stands on the centroidal moment pivot
(CMP): a swinging leg moves it away from the CoP.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from atlas_drake.frozen import Frozen, read_only

_ONE_POINT = read_only(np.zeros(2))


class Pendulum(NamedTuple):
    """The robot as the plan of a walk sees it.

    Attributes:
        omega: Natural frequency √(g/z) [1/s].
        swing_inertia: CMP - CoP for a foot that is accelerated by 1 m/s², ahead and to
            the left [s²]; zero for legs without mass.
    """

    omega: float
    swing_inertia: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class CopSegment:
    """The CoP moves on a straight line at constant speed, the CMP on a cubic beside it.

    Attributes:
        duration: Time that the motion takes [s], positive.
        start: CoP at the start, horizontal, in W [m], shape (2,).
        end: CoP at the end [m], shape (2,).
        offset: CMP - CoP as coefficients of 1, t, t², t³, with the time t since the
            start [m, m/s, ...], shape (4, 2); None where they are one point.
    """

    duration: float
    start: np.ndarray
    end: np.ndarray
    offset: np.ndarray | None = None


@dataclass(frozen=True)
class DcmReference:
    """The plan at one instant: horizontal positions in W [m], shape (2,).

    Attributes:
        dcm: Divergent component of motion.
        cop: Center of pressure.
        offset: Centroidal moment pivot, from the CoP.
    """

    dcm: np.ndarray
    cop: np.ndarray
    offset: np.ndarray = field(default_factory=lambda: _ONE_POINT)

    @property
    def cmp(self) -> np.ndarray:
        """Centroidal moment pivot."""
        return self.cop + self.offset


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

    With the CMP p as a polynomial of time the DCM is ξ = P + e^{ω(t-T)}·(ξ_T - P_T),
    where P = p + ṗ/ω + p̈/ω² + ... is the DCM that stays bounded.
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
    if segment.offset is None:
        return DcmReference(np.array(dcm), np.array(cop))
    offset = []
    # As numbers: two components cost a third of the time of small arrays.
    for axis, coefficients in enumerate(segment.offset.T.tolist()):
        now, bounded = _offset(coefficients, omega, into)
        _, bounded_end = _offset(coefficients, omega, segment.duration)
        offset.append(now)
        dcm[axis] += bounded - decay * bounded_end
    return DcmReference(np.array(dcm), np.array(cop), np.array(offset))


def _offset(
    coefficients: Sequence[float], omega: float, time: float
) -> tuple[float, float]:
    """Evaluates a cubic offset o, and o + ȯ/ω + ö/ω² + o⃛/ω³."""
    c0, c1, c2, c3 = coefficients
    offset = c0 + time * (c1 + time * (c2 + time * c3))
    rate = c1 + time * (2.0 * c2 + time * 3.0 * c3)
    second = 2.0 * c2 + time * 6.0 * c3
    return offset, offset + (rate + (second + 6.0 * c3 / omega) / omega) / omega
