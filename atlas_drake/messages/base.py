"""The base of all messages: misspelt fields, comparison, freezing.

The types of fields are in ``fields``; ``door`` checks values.
"""

import copy
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from atlas_drake.config import finished_by
from atlas_drake.errors import did_you_mean

if TYPE_CHECKING:
    from typing import Self


class Message:
    """Base of all messages, which are dataclasses with slots.

    A message is made empty and filled in field by field. What leaves the door is
    frozen: to change it, make another one by ``dataclasses.replace``.
    """

    __slots__ = ("_frozen",)
    _frozen: bool

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "strict": True,
        "allow_inf_nan": False,
        "revalidate_instances": "always",
    }

    # With these definitions type checkers would allow any arguments and any attribute,
    # and report fewer mistakes.
    if not TYPE_CHECKING:

        def __new__(cls, *args, **kwargs):
            """Make a mutable message."""
            message = object.__new__(cls)
            object.__setattr__(message, "_frozen", False)
            return message

        def __setattr__(self, name, value):
            """Set a field."""
            kind = type(self).__name__
            if self._frozen:
                raise AttributeError(
                    f"This {kind} is frozen; make a changed one by dataclasses.replace."
                )
            try:
                object.__setattr__(self, name, value)
            except AttributeError:
                known = [field.name for field in fields(self)]
                raise AttributeError(
                    f"{kind} has no field {name!r} to set.{did_you_mean(name, known)}"
                ) from None

    @property
    def is_frozen(self) -> bool:
        """True if this message and those within do not change."""
        return self._frozen

    def freeze(self) -> "Self":
        """Freeze this message and those within; lists become tuples."""
        if not self._frozen:
            for item in fields(self):  # type: ignore[arg-type]
                object.__setattr__(self, item.name, _frozen(getattr(self, item.name)))
            _mark(self)
        return self

    def __eq__(self, other: object) -> bool:
        """Compare all fields; lists, tuples and arrays by their elements."""
        if type(other) is not type(self):
            return NotImplemented
        return same_fields(self, other)

    # A mutable value has no lasting hash.
    __hash__ = None  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, Any]) -> "Self":
        """Return a deep copy; a frozen message is its own copy."""
        if self._frozen:
            return self
        memo[id(self)] = twin = copy.copy(self)
        for item in fields(self):  # type: ignore[arg-type]
            setattr(twin, item.name, copy.deepcopy(getattr(self, item.name), memo))
        return twin

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """Describe the class to pydantic; what it returns is frozen."""
        return finished_by(_mark, handler(source))


def _mark(message: Message) -> Message:
    object.__setattr__(message, "_frozen", True)
    return message


def _frozen(value: Any) -> Any:
    if isinstance(value, Message):
        return value.freeze()
    if isinstance(value, list | tuple):
        return tuple(map(_frozen, value))
    return value


def same(a: Any, b: Any) -> bool:
    """Return True if two values are equal; sequences by element, NaN equals NaN."""
    if a is b:
        return True
    a, b = (x.tolist() if isinstance(x, np.ndarray) else x for x in (a, b))
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if type(a) is type(b):
        if isinstance(a, dict):
            return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
        if is_dataclass(a) and not isinstance(a, type | Message):
            return same_fields(a, b)
    return bool(a == b) or bool(a != a and b != b)


def same_fields(a: Any, b: Any) -> bool:
    """Compare those fields of two values of a dataclass that take part."""
    return all(
        same(getattr(a, item.name), getattr(b, item.name))
        for item in fields(a)
        if item.compare
    )
