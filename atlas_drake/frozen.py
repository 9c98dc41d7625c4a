"""What the frozen values in a Context have in common: cheap copies, cheap changes.

It knows no value in particular.
"""

from __future__ import annotations

from typing import Any, TypeVar

_T = TypeVar("_T")


class Frozen:
    """Base of frozen dataclasses that pass through a Context."""

    def __deepcopy__(self: _T, memo: dict[int, Any]) -> _T:
        """Itself, as it never changes: cloning a Context costs nothing."""
        return self


class Nothing(Frozen):
    """Type of ``NOTHING``."""

    def __repr__(self) -> str:
        return "NOTHING"


NOTHING = Nothing()
"""The one value of a port, state or cache entry that has none yet.

An abstract value cannot hold None: Drake's bindings made with nanobind refuse it.
"""


def replace(value: _T, **changes: Any) -> _T:
    """The same value with some fields changed.

    Does what ``dataclasses.replace`` does at a tenth of its cost, which matters where
    it happens several times in a control tick. ``__post_init__`` is not run. Cached
    properties are computed anew.

    Args:
        value: A frozen dataclass without slots.
        **changes: Its fields that shall be different.

    Raises:
        TypeError: If there is no such field.
    """
    fields = value.__dict__
    declared = value.__dataclass_fields__  # type: ignore[attr-defined]
    if len(fields) != len(declared):
        # The rest are cached properties, which belong to the old fields.
        fields = {name: fields[name] for name in declared if name in fields}
    if not changes.keys() <= fields.keys():
        unknown = ", ".join(sorted(changes.keys() - fields.keys()))
        raise TypeError(f"{type(value).__name__} has no field {unknown}")
    other = object.__new__(type(value))
    other.__dict__.update(fields)
    other.__dict__.update(changes)
    return other
