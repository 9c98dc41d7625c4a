"""What ROS 1 made messages of: fields that begin at zero, ``Time`` and ``Duration``.

The messages themselves are in ``message_types``; ``rospy.Time.now``, which needs a
clock, is in ``rospy_module``.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Mapping
from textwrap import indent
from typing import Any, ClassVar, Self

import numpy as np

from atlas_drake.clients.ros_scripts.unknown import UnknownNameError, unknown

Factory = Callable[[], Any]
"""Makes the initial value of a field."""


class RosMessage:
    """Base of all messages; ``message_type`` makes the classes."""

    __slots__ = ()
    _type: ClassVar[str] = ""
    _factories: ClassVar[Mapping[str, Factory]] = {}
    _by_position: ClassVar[tuple[str, ...]] = ()

    def __init__(self, *values: Any, **named: Any) -> None:
        """Makes a message of values in the order of the fields, or of named ones."""
        names = self._by_position
        if values and (named or len(values) != len(names)):
            raise TypeError(
                f"{self._type} takes {len(names)} values by position "
                f"({', '.join(names)}) or fields by name, is given {len(values)}"
            )
        for name, factory in self._factories.items():
            object.__setattr__(self, name, factory())
        for name, value in (named or dict(zip(names, values, strict=False))).items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._factories:
            raise self._no_field(name)
        object.__setattr__(self, name, value)

    def __getattr__(self, name: str) -> Any:
        # Reached only where there is neither a field nor a constant of that name.
        if name.startswith("__"):
            raise AttributeError(name)
        raise self._no_field(name)

    def _no_field(self, name: str) -> Exception:
        what = f"field {name} of {self._type}"
        return unknown(what, name, self._factories, UnknownNameError)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RosMessage) or other._type != self._type:
            return NotImplemented
        return all(
            np.array_equal(getattr(self, name), getattr(other, name))
            for name in self._factories
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        lines = []
        for name in self._factories:
            text = repr(getattr(self, name))
            nested = "\n" in text
            lines.append(
                f"{name}:\n{indent(text, '  ')}" if nested else f"{name}: {text}"
            )
        return "\n".join(lines)


def message_type(
    name: str,
    fields: Mapping[str, Factory],
    constants: Mapping[str, int] | None = None,
    by_name: Collection[str] = (),
) -> type[RosMessage]:
    """Make the class of a message, by its full name such as ``std_msgs/String``.

    The fields ``by_name`` are not among the values by position.
    """
    package, short = name.split("/")
    content = {
        "__slots__": tuple(fields),
        "__module__": f"{package}.msg",
        "_type": name,
        "_factories": dict(fields),
        "_by_position": tuple(field for field in fields if field not in by_name),
        **(constants or {}),
    }
    return type(short, (RosMessage,), content)


def array_of(factory: Factory, count: int) -> Factory:
    """Return a maker of arrays of fixed length."""
    return lambda: [factory() for _ in range(count)]


NANO = 1_000_000_000
"""Nanoseconds in a second."""


@functools.total_ordering
class _Seconds:
    """Common base of ``Time`` and ``Duration``."""

    __slots__ = ("nsecs", "secs")

    def __init__(self, secs: float = 0, nsecs: float = 0) -> None:
        """Adds seconds, which may have a fraction, and nanoseconds."""
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


class Duration(_Seconds):
    """A span of time, of either sign."""

    def __mul__(self, factor: float) -> Any:
        return Duration(0, self.to_nsec() * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return self.to_nsec() / divisor.to_nsec()
        return Duration(0, self.to_nsec() / divisor)


class Time(_Seconds):
    """An instant of simulated time; 0 means "not set" in a header."""

    def __sub__(self, other: object) -> Any:
        if isinstance(other, Time):
            return Duration(0, self.to_nsec() - other.to_nsec())
        return super().__sub__(other)
