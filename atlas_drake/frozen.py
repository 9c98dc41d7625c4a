"""Frozen values in a Context: cheap copies and cheap changes.

The values themselves are defined elsewhere.
"""

from __future__ import annotations

from typing import Any, TypeVar

_T = TypeVar("_T")


class Frozen:
    """Base of frozen dataclasses that pass through a Context."""

    def __deepcopy__(self: _T, memo: dict[int, Any]) -> _T:
        """Returns the value itself, which never changes: cloning a Context is cheap."""
        return self


class Nothing(Frozen):
    """Type of ``NOTHING``."""

    def __repr__(self) -> str:
        return "NOTHING"


NOTHING = Nothing()
"""The value of a port, state or cache entry that has no value yet.

An abstract value cannot hold None: Drake's nanobind bindings refuse it.
"""


def replace(value: _T, **changes: Any) -> _T:
    """Returns a copy of the value with some fields changed.

    Works as ``dataclasses.replace`` at a tenth of its cost, which matters for several
    calls in each control tick. ``__post_init__`` is not run. The copy computes cached
    properties again.

    Args:
        value: A frozen dataclass without slots.
        **changes: New values of fields.

    Raises:
        TypeError: If there is no such field.
    """
    fields = value.__dict__
    declared = value.__dataclass_fields__  # type: ignore[attr-defined]
    if len(fields) != len(declared):
        # The other entries are cached properties, which belong to the old fields.
        fields = {name: fields[name] for name in declared if name in fields}
    if not changes.keys() <= fields.keys():
        unknown = ", ".join(sorted(changes.keys() - fields.keys()))
        raise TypeError(f"{type(value).__name__} has no field {unknown}")
    other = object.__new__(type(value))
    other.__dict__.update(fields)
    other.__dict__.update(changes)
    return other
