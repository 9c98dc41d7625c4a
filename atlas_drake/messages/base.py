"""Base of all messages: checks of field names, comparison, freezing.

Each message has a file of its own; the types of their fields are in ``fields``, and
``door`` checks their values.
"""

import copy
import functools
import operator
from collections.abc import Callable
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
            """Set a field.

            Raises:
                AttributeError: If there is no such field, or in a frozen message.
            """
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

        def __delattr__(self, name):
            """Refuse, because a message with a missing field is no message."""
            raise AttributeError(
                f"Fields of {type(self).__name__} cannot be deleted; set {name!r} "
                "to an empty value."
            )

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
        get: Any = compared(type(self))  # type: ignore[arg-type]
        mine, theirs = get(self), get(other)
        try:
            if mine == theirs:
                return True
        except ValueError:  # Two arrays have more than one answer.
            pass
        return all(map(same, mine, theirs))

    # A mutable value has no lasting hash.
    __hash__ = None  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, Any]) -> "Self":
        """Return a deep copy; a frozen message is its own copy."""
        if self._frozen:
            return self
        twin = type(self).__new__(type(self))
        memo[id(self)] = twin
        for item in fields(self):  # type: ignore[arg-type]
            value = copy.deepcopy(getattr(self, item.name), memo)
            object.__setattr__(twin, item.name, value)
        return twin

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """Describe the class to pydantic; what it returns is frozen."""
        return finished_by(_mark, handler(source), handler)


def _mark(message: Message) -> Message:
    object.__setattr__(message, "_frozen", True)
    return message


def _frozen(value: Any) -> Any:
    if isinstance(value, Message):
        return value.freeze()
    if isinstance(value, list | tuple):
        return tuple(map(_frozen, value))
    return value


@functools.cache
def compared(kind: type) -> Callable[[Any], tuple[Any, ...]]:
    """Return a function that reads the fields of a dataclass that are compared."""
    names = [item.name for item in fields(kind) if item.compare]
    if len(names) > 1:
        return operator.attrgetter(*names)
    return lambda value: tuple(getattr(value, name) for name in names)


def same(a: Any, b: Any) -> bool:
    """Return True if two values of a field are equal.

    Lists, tuples and arrays are compared by their elements, dataclasses and mappings by
    their values, and objects that do not define equality by their type. NaN equals NaN.
    """
    if _is_numeric(a) and _is_numeric(b):
        return np.array_equal(a, b, equal_nan=True)
    if _is_sequence(a) and _is_sequence(b):
        return len(a) == len(b) and all(map(same, a, b))
    if type(a) is not type(b):
        return bool(np.all(a == b))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if is_dataclass(a) and not isinstance(a, type | Message):
        get = compared(type(a))
        return all(map(same, get(a), get(b)))
    both_nan = bool(np.all(a != a) and np.all(b != b))
    return bool(np.all(a == b)) or both_nan or not _defines_equality(type(a))


def _defines_equality(kind: Any) -> bool:
    return kind.__eq__ is not object.__eq__


def _is_numeric(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind in "biuf"


def _is_sequence(value: Any) -> bool:
    return isinstance(value, list | tuple) or (
        isinstance(value, np.ndarray) and value.ndim > 0
    )
