"""``Outputs``: what shows and records a run."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydrake.geometry import Meshcat

from atlas_drake.errors import shown
from atlas_drake.messages.event import Event
from atlas_drake.visualization.overlays import Overlays

_RULES: dict[str, tuple[Any, str]] = {
    "view": (bool | Meshcat, "True, False or a Meshcat of pydrake.geometry{}"),
    "overlays": (
        Overlays,
        "Overlays of atlas_drake.visualization.overlays{}, such as "
        "Overlays(['com', 'dcm'])",
    ),
    "log": (str | os.PathLike, "the name of a file{}, such as 'run.mcap'"),
    "on_event": (Callable, "a callable (event) -> None{}"),
}
"""Type of each field, and what an error says around the given value."""


@dataclass(frozen=True)
class Outputs:
    """View, log and listener, as ``AtlasSimulation`` takes and explains them."""

    view: bool | Meshcat | None = None
    overlays: Overlays | None = None
    log: str | Path | None = None
    on_event: Callable[[Event], None] | None = None

    def __post_init__(self) -> None:
        """Checks the types; None is valid.

        Raises:
            TypeError: Naming the field and a correct value.
        """
        for name, (kind, rule) in _RULES.items():
            value = getattr(self, name)
            if value is not None and not isinstance(value, kind):
                raise TypeError(f"{name} must be {rule.format(f', is {shown(value)}')}")
