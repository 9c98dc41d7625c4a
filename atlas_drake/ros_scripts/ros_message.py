"""Messages as ROS 1 made them: mutable, zero until filled in, fields by name.

The messages themselves are in ``message_types``; their conversion to the messages of
this package is in ``conversion``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from atlas_drake.ros_scripts.unknown import UnknownNameError, unknown

Factory = Callable[[], Any]
"""Makes the initial value of a field."""


class RosMessage:
    """Base of all messages; ``message_type`` makes the classes."""

    __slots__ = ()
    _type: ClassVar[str] = ""
    _factories: ClassVar[Mapping[str, Factory]] = {}

    def __init__(self, *values: Any, **named: Any) -> None:
        """Makes a message of values in the order of the fields, or of named ones."""
        names = tuple(self._factories)
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
        return "\n".join(_lines(self))


def message_type(
    name: str, fields: Mapping[str, Factory], constants: Mapping[str, int] | None = None
) -> type[RosMessage]:
    """Make the class of a message, by its full name such as ``std_msgs/String``."""
    package, short = name.split("/")
    content = {
        "__slots__": tuple(fields),
        "__module__": f"{package}.msg",
        "_type": name,
        "_factories": dict(fields),
        **(constants or {}),
    }
    return type(short, (RosMessage,), content)


def array_of(factory: Factory, count: int) -> Factory:
    """Return a maker of arrays of fixed length."""
    return lambda: [factory() for _ in range(count)]


def _lines(message: RosMessage) -> list[str]:
    """Return the lines that ``print`` shows, as YAML."""
    lines = []
    for name in message._factories:
        value = getattr(message, name)
        parts = value if isinstance(value, list) else [value]
        if not any(isinstance(part, RosMessage) for part in parts):
            lines.append(f"{name}: {value!r}")
            continue
        lines.append(f"{name}:")
        for part in parts:
            lines += ["  -"] * (parts is value)
            lines += [f"  {line}" for line in _lines(part)]
    return lines
