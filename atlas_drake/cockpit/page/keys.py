"""Keys of the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Key:
    """What a key does."""

    control: str
    values: Mapping[str, Any] = field(default_factory=dict)
    text: str = ""


def _walk(text: str, **direction: float) -> Key:
    return Key("walk.steer", direction, text)


DIRECTIONS = {
    "u": _walk("arc left", forward=1.0, turn=1.0),
    "i": _walk("forward", forward=1.0),
    "o": _walk("arc right", forward=1.0, turn=-1.0),
    "j": _walk("left", left=1.0),
    "k": Key("walk.stop", {}, "stop walking"),
    "l": _walk("right", left=-1.0),
    "m": _walk("turn left", turn=1.0),
    ",": _walk("backward", forward=-1.0),
    ".": _walk("turn right", turn=-1.0),
}
"""Keys of the walk, row by row as they lie on the keyboard."""
MODES = {
    "1": "STAND",
    "2": "WALK",
    "3": "STEP",
    "4": "MANIPULATE",
    "5": "FREEZE",
    "6": "USER",
    "7": "STAND_PREP",
}
"""Keys of the behaviors."""
KEYS: dict[str, Key] = {
    **DIRECTIONS,
    **{key: Key("modes.request", {"name": name}, name) for key, name in MODES.items()},
    "Escape": Key("modes.stop", {}, "STOP"),
    " ": Key("clock.toggle", {}, "pause or go on"),
    "n": Key("clock.single_step", {}, "single step"),
    "b": Key("clock.back", {}, "back ten seconds"),
    "r": Key("clock.reset", {}, "reset"),
}
"""All keys, by the name that a browser gives."""
