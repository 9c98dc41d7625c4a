"""Base of all messages: checks of field names, comparison, snapshots.

A snapshot is the immutable copy that is sent and kept. ``frozen`` and ``same_content``
accept any value that a sender may put into a message, or in its place, and never raise.
Each message has a file of its own; validation is in ``validation``.
"""

import copy
import functools
import operator
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.errors import did_you_mean
from atlas_drake.frozen import NOTHING
from atlas_drake.numeric import plain_number

if TYPE_CHECKING:
    from typing import Self

UNNUMBERED = 0
"""Number of a message whose sender does not number messages."""


class Message:
    """Base of all messages, which are dataclasses with slots.

    A message is made empty and filled in field by field. Sending it takes a
    ``snapshot``, so that the sender may continue to change the message.
    """

    __slots__ = ("_frozen", "_number")
    _frozen: bool
    _number: int

    # With these definitions type checkers would allow any arguments and any attribute,
    # and report fewer mistakes.
    if not TYPE_CHECKING:

        def __new__(cls, *args, **kwargs):
            """Make a mutable message."""
            message = object.__new__(cls)
            object.__setattr__(message, "_frozen", False)
            object.__setattr__(message, "_number", UNNUMBERED)
            return message

        def __setattr__(self, name, value):
            """Set a field.

            Raises:
                AttributeError: If there is no such field, or in a snapshot.
            """
            kind = type(self).__name__
            if self._frozen:
                raise AttributeError(
                    f"This {kind} is a snapshot and does not change; change a "
                    "mutable_copy() of it."
                )
            try:
                object.__setattr__(self, name, value)
            except AttributeError:
                if hasattr(type(self), name):
                    problem = f"{name!r} of {kind} is a constant."
                else:
                    known = [field.name for field in fields(self)]
                    problem = (
                        f"{kind} has no field {name!r}.{did_you_mean(name, known)}"
                    )
                raise AttributeError(problem) from None

        def __delattr__(self, name):
            """Refuse, because a message with a missing field is no message."""
            raise AttributeError(
                f"Fields of {type(self).__name__} cannot be deleted; set {name!r} "
                "to an empty value."
            )

    def __eq__(self, other: object) -> bool:
        """Compare all fields; lists, tuples and arrays by their elements."""
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _equal(getattr(self, field.name), getattr(other, field.name))
            for field in fields(self)  # type: ignore[arg-type]
        )

    # A mutable value has no lasting hash.
    __hash__ = None  # type: ignore[assignment]

    def snapshot(self) -> "Self":
        """Return an immutable copy.

        At every depth lists become tuples, arrays become read-only and numbers become
        Python's own. A snapshot of a snapshot is the same object, and so is its deep
        copy, which makes passing it through a diagram cheap.
        """
        return self._fixed((id(self),))

    def numbered(self, number: int) -> "Self":
        """Return a snapshot that counts as new even if its content was sent before.

        Args:
            number: Not 0, and not the number of the sender's previous message.
        """
        twin = copy.copy(self.snapshot())
        object.__setattr__(twin, "_number", number)
        return twin

    def _fixed(self, path: "_Path") -> "Self":
        """Return a snapshot; ``path`` ends with this message itself."""
        if self._frozen:
            return self
        twin = type(self).__new__(type(self))
        for name in self.__dataclass_fields__:  # type: ignore[attr-defined]
            value = frozen(getattr(self, name), path)
            object.__setattr__(twin, name, value)
        object.__setattr__(twin, "_frozen", True)
        return twin

    def mutable_copy(self) -> "Self":
        """Return a mutable deep copy, also of a snapshot."""
        twin = type(self).__new__(type(self))
        for name in self.__dataclass_fields__:  # type: ignore[attr-defined]
            object.__setattr__(twin, name, _editable(getattr(self, name)))
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> "Self":
        """Return a deep copy; an immutable snapshot is its own copy."""
        if self._frozen:
            return self
        twin = type(self).__new__(type(self))
        memo[id(self)] = twin
        for field in fields(self):  # type: ignore[arg-type]
            value = copy.deepcopy(getattr(self, field.name), memo)
            object.__setattr__(twin, field.name, value)
        return twin

    def __getstate__(self) -> tuple[bool, dict[str, Any]]:
        """Return the state for pickling."""
        values = {
            field.name: getattr(self, field.name)
            for field in fields(self)  # type: ignore[arg-type]
        }
        return self._frozen, values

    def __setstate__(self, state: tuple[bool, dict[str, Any]]) -> None:
        """Restore a pickled state; freeze the arrays of a snapshot again."""
        is_frozen, values = state
        for name, value in values.items():
            object.__setattr__(self, name, frozen(value) if is_frozen else value)
        object.__setattr__(self, "_frozen", is_frozen)


_IMMUTABLE = (float, int, bool, str, type(None))
_KEYS = set(_IMMUTABLE)

DEEPEST = 8
"""Greatest nesting depth that is followed; more than that of any message."""

_Path = tuple[int, ...]
"""Identities of the containers around a value, to notice one that contains itself."""


def _enters(value: object, path: _Path) -> bool:
    """Return True if a container may be entered: it is neither too deep nor a loop."""
    return len(path) < DEEPEST and id(value) not in path


def frozen(value: Any, path: _Path = ()) -> Any:
    """Return an immutable copy of a value of any type.

    Numbers become Python's own. A value that no valid message can hold, such as a
    generator or a list that contains itself, is returned as given: validation refuses
    the message, and the error shows the value.
    """
    if type(value) in _IMMUTABLE:
        return value
    if isinstance(value, np.ndarray):
        twin = value.copy()
        twin.setflags(write=False)
        return twin
    if isinstance(value, (list, tuple)) and set(map(type, value)) <= _NUMBERS:
        return tuple(value)
    if isinstance(value, (Message, list, tuple)) and _enters(value, path):
        within = (*path, id(value))
        if isinstance(value, Message):
            return value._fixed(within)
        return tuple(frozen(element, within) for element in value)
    if is_record(value) and _enters(value, path):
        return _frozen_record(value, (*path, id(value)))
    if _is_collection(value) and _enters(value, path):
        if isinstance(value, set):
            return set(value)
        within = (*path, id(value))
        return {key: frozen(item, within) for key, item in value.items()}
    return plain_number(value)


def _is_collection(value: object) -> bool:
    """Return True for a mapping or a set with keys that compare safely.

    Parameters of a user's own behavior may have such fields.
    """
    kind: Any = value
    return type(value) in (dict, set) and set(map(type, kind)) <= _KEYS


def is_record(value: object) -> bool:
    """Return True for an instance of a dataclass that is not a message."""
    return is_dataclass(value) and not isinstance(value, (type, Message))


def _frozen_record(value: Any, path: _Path) -> Any:
    """Return a copy of a dataclass instance with immutable fields.

    An instance of a dataclass that is not frozen stays mutable at its top level; the
    holder of the copy must not hand it out.
    """
    twin = copy.copy(value)
    for item in fields(value):
        object.__setattr__(twin, item.name, frozen(getattr(value, item.name), path))
    return twin


_NUMBERS = {float, int}
"""Types of the elements of nearly every list."""


def same_content(value: Any, seen: Any, path: _Path = ()) -> bool:
    """Return True if a value has the content of a frozen value seen earlier.

    Never raises. NaN equals NaN. Two values of one type that no valid message can hold
    count as equal. True differs from 1, because one may be refused where the other is
    accepted. Fast if nothing changed.

    Args:
        value: A message, or any value in its place; it may have changed since.
        seen: Result of ``frozen`` for the earlier value.
        path: Identities of the containers around ``value``.
    """
    # Unchanged fields are the same immutable objects.
    if value is seen:
        return True
    if isinstance(value, Message) and _enters(value, path):
        if type(value) is not type(seen):
            return False
        within = (*path, id(value))
        get = _fields_getter(type(value))  # type: ignore[arg-type]
        return all(
            now is before or same_content(now, before, within)
            for now, before in zip(get(value), get(seen), strict=True)
        )
    if isinstance(value, (list, tuple)) and _enters(value, path):
        return _same_elements(value, seen, (*path, id(value)))
    if isinstance(value, _IMMUTABLE):
        return (
            isinstance(seen, _IMMUTABLE)
            and isinstance(value, bool) == isinstance(seen, bool)
            and (bool(value == seen) or (value != value and seen != seen))
        )
    if isinstance(value, np.ndarray):
        return _same_array(value, seen, path)
    if is_record(value) and _enters(value, path):
        return type(value) is type(seen) and all(
            same_content(
                getattr(value, item.name), getattr(seen, item.name), (*path, id(value))
            )
            for item in fields(value)
        )
    if _is_collection(value) and _enters(value, path):
        return _same_collection(value, seen, (*path, id(value)))
    number = plain_number(value)
    if number is not value:
        return same_content(number, seen)
    return type(value) is type(seen)


@functools.cache
def _fields_getter(kind: type[Message]) -> Callable[[Any], tuple[Any, ...]]:
    """Return a function that reads all fields of a message of that kind at once."""
    names = list(kind.__dataclass_fields__)  # type: ignore[attr-defined]
    if len(names) > 1:
        return operator.attrgetter(*names)
    return lambda message: tuple(getattr(message, name) for name in names)


def _same_elements(value: Any, seen: Any, path: _Path) -> bool:
    """Compare a sequence; ``path`` ends with it."""
    if not isinstance(seen, (list, tuple)) or len(value) != len(seen):
        return False
    types = {*map(type, value), *map(type, seen)}
    if types <= _NUMBERS and tuple(value) == tuple(seen):
        return True
    return all(
        now is before or same_content(now, before, path)
        for now, before in zip(value, seen, strict=True)
    )


def _same_collection(value: Any, seen: Any, path: _Path) -> bool:
    """Compare a mapping or set; ``path`` ends with it."""
    if type(value) is not type(seen) or not _is_collection(seen):
        return False
    if isinstance(value, set):
        return bool(value == seen)
    return value.keys() == seen.keys() and all(
        same_content(item, seen[key], path) for key, item in value.items()
    )


def _same_array(value: np.ndarray, seen: Any, path: _Path) -> bool:
    if (
        type(value) is not type(seen)
        or value.dtype != seen.dtype
        or value.shape != seen.shape
    ):
        return False
    if value.dtype.hasobject:
        return same_content(value.tolist(), seen.tolist(), path)
    return value.tobytes() == seen.tobytes()


def is_new(value: Any, seen: Any) -> bool:
    """Return True if a port holds a new message.

    A message is new if its content, including the stamp, or its number differs from the
    one seen before. Object identity does not count: a sender may change a message and
    send it again.

    Args:
        value: Value of the port; NOTHING is not new.
        seen: Result of ``frozen`` for the previous value; NOTHING at first.
    """
    if value is NOTHING or value is seen:
        return False
    number = value._number if isinstance(value, Message) else UNNUMBERED
    if number != UNNUMBERED and number != getattr(seen, "_number", UNNUMBERED):
        return True
    return not same_content(value, seen)


def _editable(value: Any) -> Any:
    """Return a mutable copy of a field's value."""
    if isinstance(value, _IMMUTABLE):
        return value
    if isinstance(value, Message):
        return value.mutable_copy()
    if isinstance(value, (list, tuple)):
        return [_editable(element) for element in value]
    return copy.deepcopy(value)


def _equal(a: Any, b: Any) -> bool:
    """Compare two values of a field, of any type; return one truth value."""
    if _is_sequence(a) and _is_sequence(b):
        return len(a) == len(b) and all(map(_equal, a, b))
    same = a == b
    # Only the comparison of an array with another type gives more than one answer.
    return same if isinstance(same, bool) else bool(np.all(same))


def _is_sequence(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or (
        isinstance(value, np.ndarray) and value.ndim > 0
    )
