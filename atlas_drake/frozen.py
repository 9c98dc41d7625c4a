"""Frozen values in a Context: cheap copies, cheap changes, read-only arrays.

The values themselves are defined elsewhere.
"""

from __future__ import annotations

from itertools import zip_longest
from typing import Any, TypeVar

import numpy as np

_T = TypeVar("_T")


class Frozen:
    """Base of values that pass through a Context, such as frozen dataclasses."""

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
    """Returns a copy of a frozen dataclass without slots, with some fields changed.

    Works as ``dataclasses.replace`` at a tenth of its cost, which matters in each
    control tick. ``__post_init__`` is not run, and cached properties are not copied.
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


def read_only(value: _T, before: Any = None) -> _T:
    """Makes all arrays within a value read-only, and returns the value.

    Parts that are those of ``before``, which is read-only, are skipped, so that each
    tick costs what it changes.
    """
    if value is before or type(value) in _IMMUTABLE:
        return value
    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    elif isinstance(value, (tuple, list)):
        earlier = before if isinstance(before, (tuple, list)) else ()
        # A queue loses its first items.
        lost = max(len(earlier) - len(value), 0)
        for item, old in zip_longest(value, earlier[lost:]):
            read_only(item, old)
    elif isinstance(value, dict):
        old = before if isinstance(before, dict) else {}
        for key, item in value.items():
            read_only(item, old.get(key))
    elif getattr(value, "_frozen", False):
        # A snapshot of a message is immutable as it is.
        return value
    elif isinstance(value, Frozen):
        for name, item in vars(value).items():
            read_only(item, getattr(before, name, None))
    elif not isinstance(value, type):
        for name in getattr(value, "__dataclass_fields__", ()):
            read_only(getattr(value, name), getattr(before, name, None))
    return value


_IMMUTABLE = (float, int, bool, str, type(None))
