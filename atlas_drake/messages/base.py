"""What all messages share: misspelt fields caught, comparison, snapshots.

The messages themselves are in their own files; what is valid is in ``validation``.
"""

import copy
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.errors import did_you_mean

if TYPE_CHECKING:
    from typing import Self

FloatArray = list[float] | NDArray[Any]
"""One number for each joint in message order, or nothing: "leave what is in force"."""

IntArray = list[int] | NDArray[Any]
"""One whole number for each joint in message order, or nothing, likewise."""


class Message:
    """Base of all messages, which are dataclasses with slots.

    A message is made empty and filled in field by field. Sending it takes a
    ``snapshot``, so that the sender may go on using and changing its own message.
    """

    __slots__ = ("_frozen",)
    _frozen: bool

    # Type checkers would take these definitions to allow any arguments and any
    # attribute, and report fewer mistakes for it.
    if not TYPE_CHECKING:

        def __new__(cls, *args, **kwargs):
            """Make a message that may be changed."""
            message = object.__new__(cls)
            object.__setattr__(message, "_frozen", False)
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

    # What can change has no hash that lasts.
    __hash__ = None  # type: ignore[assignment]

    def snapshot(self) -> "Self":
        """Return a copy that nobody can change.

        Lists become tuples and arrays read-only, at every depth. A snapshot of a
        snapshot is itself, and so is its deep copy, which makes passing it through a
        diagram cheap.
        """
        if self._frozen:
            return self
        twin = self._rebuilt(_fixed)
        object.__setattr__(twin, "_frozen", True)
        return twin

    def mutable_copy(self) -> "Self":
        """Return a deep copy that may be changed, also of a snapshot."""
        return self._rebuilt(_editable)

    def _rebuilt(self, convert: Any) -> "Self":
        twin = type(self).__new__(type(self))
        for field in fields(self):  # type: ignore[arg-type]
            object.__setattr__(twin, field.name, convert(getattr(self, field.name)))
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> "Self":
        """Return a deep copy; a snapshot, which cannot change, stands for its own."""
        if self._frozen:
            return self
        twin = type(self).__new__(type(self))
        memo[id(self)] = twin
        for field in fields(self):  # type: ignore[arg-type]
            value = copy.deepcopy(getattr(self, field.name), memo)
            object.__setattr__(twin, field.name, value)
        return twin

    def __getstate__(self) -> tuple[bool, dict[str, Any]]:
        """Return what pickling has to keep."""
        values = {
            field.name: getattr(self, field.name)
            for field in fields(self)  # type: ignore[arg-type]
        }
        return self._frozen, values

    def __setstate__(self, state: tuple[bool, dict[str, Any]]) -> None:
        """Restore what pickling kept; arrays come out of it writable."""
        frozen, values = state
        for name, value in values.items():
            object.__setattr__(self, name, _fixed(value) if frozen else value)
        object.__setattr__(self, "_frozen", frozen)


_IMMUTABLE = (float, int, str, type(None))


def _fixed(value: Any) -> Any:
    """Return a copy of a field's value that nobody can change."""
    if isinstance(value, _IMMUTABLE):
        return value
    if isinstance(value, Message):
        return value.snapshot()
    if isinstance(value, (list, tuple)):
        return tuple(_fixed(element) for element in value)
    twin = copy.deepcopy(value)
    if isinstance(twin, np.ndarray):
        twin.setflags(write=False)
    return twin


def _editable(value: Any) -> Any:
    """Return a copy of a field's value that may be changed."""
    if isinstance(value, Message):
        return value.mutable_copy()
    if isinstance(value, (list, tuple)):
        return [_editable(element) for element in value]
    return copy.deepcopy(value)


def _equal(a: Any, b: Any) -> bool:
    """Compare two values of a field, whatever they hold, to one truth value."""
    if _is_sequence(a) and _is_sequence(b):
        return len(a) == len(b) and all(map(_equal, a, b))
    same = a == b
    # Only an array, compared with something that is none, gives more than one answer.
    return same if isinstance(same, bool) else bool(np.all(same))


def _is_sequence(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or (
        isinstance(value, np.ndarray) and value.ndim > 0
    )
