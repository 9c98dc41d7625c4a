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
    """A bounded DCM trajectory that ends at rest over the last segment's end."""

    def __init__(self, segments: Sequence[CopSegment], omega: float):
        """Solves the plan.

        Args:
            segments: One or more segments in order of time; the first starts at time 0.
            omega: Natural frequency of the pendulum √(g/z) [1/s].
        """
        self.omega = omega
        self._segments = tuple(segments)
        self._ends = list(accumulate(segment.duration for segment in segments))
        pieces = []
        final = np.asarray(segments[-1].end, dtype=float)
        for segment in reversed(self._segments):
            piece = _Piece.before(final, segment, omega)
            pieces.append(piece)
            final = piece.evaluate(0.0).dcm
        self._pieces = tuple(reversed(pieces))

    @property
    def segments(self) -> tuple[CopSegment, ...]:
        """Segments of the plan, in order of time."""
        return self._segments

    @property
    def duration(self) -> float:
        """Time of the last segment's end [s]."""
        return self._ends[-1]

    def evaluate(self, time: float) -> DcmReference:
        """Computes the reference at ``time`` [s]; constant beyond the plan's ends."""
        time = min(max(time, 0.0), self.duration)
        index = min(bisect_right(self._ends, time), len(self._pieces) - 1)
        piece = self._pieces[index]
        return piece.evaluate(time - (self._ends[index] - piece.duration))


@dataclass(frozen=True)
class _Piece:
    """Constants of the DCM's motion within one segment.

    With the CoP at p = p₀ + ṗ·t the DCM is ξ = p + ṗ/ω + e^{ω(t-T)}·(ξ_T - p_T - ṗ/ω).
    """

    duration: float
    omega: float
    start: np.ndarray
    rate: np.ndarray
    ahead: np.ndarray
    """ṗ/ω: lead of the DCM over the CoP at which their distance stays constant."""
    apart: np.ndarray
    """Distance between the final DCM and that lead point."""

    @classmethod
    def before(cls, final: np.ndarray, segment: CopSegment, omega: float) -> _Piece:
        """Makes the piece for a segment that ends with the DCM at ``final``."""
        rate = (segment.end - segment.start) / segment.duration
        ahead = rate / omega
        apart = final - segment.end - ahead
        return cls(segment.duration, omega, segment.start, rate, ahead, apart)

    def evaluate(self, into: float) -> DcmReference:
        """Computes the reference at the time ``into`` the segment [s]."""
        cop = self.start + self.rate * into
        decay = math.exp(self.omega * (into - self.duration))
        return DcmReference(dcm=cop + self.ahead + decay * self.apart, cop=cop)
