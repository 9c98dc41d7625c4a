"""Messages as ROS 1 made them: mutable, zero until filled in, fields by name.

The messages themselves are in ``message_types``; their conversion to the messages of
this package is in ``conversion``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from atlas_drake.ros_scripts.unknown import UnknownNameError, unknown

Factory = Callable[[], Any]
"""Makes the initial value of a field."""


class RosMessage:
    """Base of all messages; ``message_type`` makes the classes."""

    __slots__ = ()
    _type: ClassVar[str] = ""
    _factories: ClassVar[Mapping[str, Factory]] = {}

    def __init__(self, *values: Any, **named: Any) -> None:
        """Makes a message.

        Args:
            values: Values of all fields in their order, or nothing.
            named: Values of fields by name.

        Raises:
            TypeError: If the number of values is wrong.
            UnknownNameError: If there is no such field.
        """
        names = tuple(self._factories)
        if values and (named or len(values) != len(names)):
            raise TypeError(
                f"{self._type} takes {len(names)} values by position "
                f"({', '.join(names)}) or fields by name, is given {len(values)}"
            )
        named.update(zip(names, values, strict=False))
        for name, factory in self._factories.items():
            value = named.pop(name) if name in named else factory()
            object.__setattr__(self, name, value)
        for name in named:
            raise self._no_field(name)

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
            _same(getattr(self, name), getattr(other, name)) for name in self._factories
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "\n".join(_lines(self, ""))


def message_type(
    name: str,
    fields: Mapping[str, Factory],
    constants: Mapping[str, Any] | None = None,
) -> type[RosMessage]:
    """Make the class of a message.

    Args:
        name: Full name, such as ``std_msgs/String``.
        fields: Makers of the initial values, by field, in the message's order.
        constants: Constants of the class, by name.
    """
    content = {
        "__slots__": tuple(fields),
        "__doc__": f"{name}: {', '.join(fields) or 'no fields'}.",
        "_type": name,
        "_factories": dict(fields),
        **(constants or {}),
    }
    package, short = name.split("/")
    content["__module__"] = f"{package}.msg"
    return type(short, (RosMessage,), content)


def array_of(factory: Factory, count: int) -> Factory:
    """Return a maker of arrays of fixed length."""
    return lambda: [factory() for _ in range(count)]


def _same(one: Any, other: Any) -> bool:
    """Compare two values of a field; sequences by their elements."""
    try:
        if len(one) != len(other) or isinstance(one, str) != isinstance(other, str):
            return False
    except TypeError:
        return bool(one == other)
    if isinstance(one, str):
        return bool(one == other)
    return all(_same(a, b) for a, b in zip(one, other, strict=True))


def _lines(message: RosMessage, indent: str) -> list[str]:
    """Return the lines that ``print`` shows, as YAML."""
    lines = []
    for name in message._factories:
        value = getattr(message, name)
        if isinstance(value, RosMessage):
            lines += [f"{indent}{name}:", *_lines(value, indent + "  ")]
        elif isinstance(value, list) and any(isinstance(v, RosMessage) for v in value):
            lines.append(f"{indent}{name}:")
            for item in value:
                lines += [f"{indent}  -", *_lines(item, indent + "    ")]
        else:
            lines.append(f"{indent}{name}: {value!r}")
    return lines
