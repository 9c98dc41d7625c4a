"""``Time`` and ``Duration`` as ROS 1 has them: whole seconds and nanoseconds.

``rospy.Time.now``, which needs a clock, is in ``rospy_module``.
"""

from __future__ import annotations

import functools
from typing import Any, Self

NANO = 1_000_000_000
"""Nanoseconds in a second."""


@functools.total_ordering
class _Seconds:
    """Common base of ``Time`` and ``Duration``."""

    __slots__ = ("nsecs", "secs")

    def __init__(self, secs: float = 0, nsecs: float = 0) -> None:
        """Stores seconds, which may have a fraction, and nanoseconds, in addition."""
        total = round(secs * NANO) if isinstance(secs, float) else int(secs) * NANO
        self.secs, self.nsecs = divmod(total + round(nsecs), NANO)

    @classmethod
    def from_sec(cls, seconds: float) -> Self:
        """Return a value of so many seconds."""
        return cls(float(seconds))

    def to_sec(self) -> float:
        """Return the value in seconds."""
        return self.secs + self.nsecs / NANO

    def to_nsec(self) -> int:
        """Return the value in nanoseconds."""
        return self.secs * NANO + self.nsecs

    def __bool__(self) -> bool:
        return self.to_nsec() != 0

    def __hash__(self) -> int:
        return hash(self.to_nsec())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Seconds):
            return NotImplemented
        return self.to_nsec() == other.to_nsec()

    def __lt__(self, other: object) -> bool:
        if not isinstance(other, _Seconds):
            return NotImplemented
        return self.to_nsec() < other.to_nsec()

    def __add__(self, other: object) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(0, self.to_nsec() + other.to_nsec())

    def __sub__(self, other: object) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(0, self.to_nsec() - other.to_nsec())

    def __repr__(self) -> str:
        return f"{type(self).__name__}[{self.to_nsec()}]"

    def __str__(self) -> str:
        return str(self.to_nsec())


class Duration(_Seconds):
    """A span of time, of either sign."""

    def __mul__(self, factor: float) -> Any:
        return Duration(0, self.to_nsec() * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return self.to_nsec() / divisor.to_nsec()
        return Duration(0, self.to_nsec() / divisor)

    def __neg__(self) -> Duration:
        return self * -1


class Time(_Seconds):
    """An instant of simulated time; 0 means "not set" in a header."""

    __radd__ = _Seconds.__add__

    def __sub__(self, other: object) -> Any:
        if isinstance(other, Time):
            return Duration(0, self.to_nsec() - other.to_nsec())
        return super().__sub__(other)
