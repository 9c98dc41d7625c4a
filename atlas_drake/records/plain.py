"""Converts values of a run to plain data, as JSON has it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from atlas_drake.config import is_whole
from atlas_drake.errors import shown

DEEPEST = 16
"""Greatest nesting depth that is kept; no valid message is nested deeper."""


def to_plain(value: Any, path: tuple[int, ...] = ()) -> Any:
    """Converts messages, arrays and numbers to JSON types; NaN and infinities to None.

    Accepts any content of a refused message: unknown types become text. ``path`` holds
    the identities of the containers around ``value``, to detect a loop.
    """
    if value is None:
        return value
    if isinstance(value, str):
        # A half of a character is no text for other programs.
        return value if value.isascii() else value.encode(errors="replace").decode()
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if is_whole(value):
        return int(value) if abs(value) <= LARGEST_INTEGER else shown(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    if id(value) in path or len(path) == DEEPEST:
        return "..."
    within = (*path, id(value))
    if is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: to_plain(getattr(value, field.name), within)
            for field in fields(value)
        }
    if isinstance(value, Mapping):
        return {str(key): to_plain(item, within) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return to_plain(value.tolist(), within)
    if isinstance(value, (list, tuple)):
        return [to_plain(item, within) for item in value]
    return shown(value)


LARGEST_INTEGER = 2**63 - 1
"""Largest integer that every reader of a log can represent."""
