"""Reference motion of the divergent component of motion (DCM) over future steps.

The linear inverted pendulum with a piecewise-linear centre of pressure (CoP),
solved backward in time from where the robot shall come to rest. After Englsberger,
Ott, Albu-Schäffer, "Three-dimensional bipedal walking control based on divergent
component of motion", T-RO 2015. Knows nothing of feet or phases.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np


@dataclass(frozen=True)
class CopSegment:
    """The CoP moves on a straight line at constant speed.

    Attributes:
        duration: [s], positive.
        start: CoP at the beginning, horizontal, in W [m], shape (2,).
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


class DcmPlan:
    """A bounded DCM trajectory that ends at rest over the last segment's end."""

    def __init__(self, segments: Sequence[CopSegment], omega: float):
        """Solves the plan.

        Args:
            segments: At least one, in order of time, starting at time 0.
            omega: Natural frequency of the pendulum √(g/z) [1/s].
        """
        self.omega = omega
        self._segments = tuple(segments)
        self._ends = list(accumulate(segment.duration for segment in segments))
        finals = []
        final = np.asarray(segments[-1].end, dtype=float)
        for segment in reversed(self._segments):
            finals.append(final)
            final = self._dcm(segment, 0.0, final)
        self._final_dcm = tuple(reversed(finals))

    @property
    def segments(self) -> tuple[CopSegment, ...]:
        """What it was made from."""
        return self._segments

    @property
    def duration(self) -> float:
        """Time of the last segment's end [s]."""
        return self._ends[-1]

    def evaluate(self, time: float) -> DcmReference:
        """The reference at ``time`` [s], held beyond either end."""
        time = min(max(time, 0.0), self.duration)
        last = len(self._segments) - 1
        index = min(bisect_right(self._ends, time), last)
        segment = self._segments[index]
        into = time - (self._ends[index] - segment.duration)
        rate = (segment.end - segment.start) / segment.duration
        return DcmReference(
            dcm=self._dcm(segment, into, self._final_dcm[index]),
            cop=segment.start + rate * into,
        )

    def _dcm(self, segment: CopSegment, into: float, final: np.ndarray) -> np.ndarray:
        """DCM ``into`` a segment that ends with the DCM at ``final``."""
        drift = (segment.end - segment.start) / (segment.duration * self.omega)
        cop = segment.start + drift * (self.omega * into)
        decay = math.exp(self.omega * (into - segment.duration))
        return cop + drift + decay * (final - segment.end - drift)
