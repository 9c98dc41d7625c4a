"""The state message while behaviors fill it in: its parts are made when they are read.

A report has about seventy messages within it, of which a behavior fills in a few. What
is reported is decided in ``supervisor``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import MISSING, fields
from typing import Any

from atlas_drake.messages import AtlasSimInterfaceState

_FIELDS = {field.name: field for field in fields(AtlasSimInterfaceState)}
_BLANK = AtlasSimInterfaceState().snapshot()
"""The parts of every report that nobody fills in."""


class ReportDraft(AtlasSimInterfaceState):
    """An ``AtlasSimInterfaceState`` whose fields have their defaults once read."""

    __slots__ = ()

    def __init__(self) -> None:
        """Makes nothing yet."""

    def __getattr__(self, name: str) -> Any:
        """Makes a field that is read for the first time."""
        field = _FIELDS.get(name)
        if field is None:
            raise AttributeError(f"AtlasSimInterfaceState has no field {name!r}")
        if field.default_factory is not MISSING:
            value = field.default_factory()
        else:
            value = field.default
        setattr(self, name, value)
        return value

    def parts(self, names: Iterable[str]) -> dict[str, Any]:
        """Returns fields by name; one that was not read or set is a blank snapshot."""
        parts = {}
        for name in names:
            try:
                parts[name] = object.__getattribute__(self, name)
            except AttributeError:
                parts[name] = getattr(_BLANK, name)
        return parts
