"""What the page knows of the settings of a scenario: plain values, sent once a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Setting:
    """One field of a scenario."""

    path: str
    value: Any
    usual: Any
    text: str
    unit: str
    kind: str
    bounds: str
    choices: tuple[str, ...]
    needs: str

    @property
    def group(self) -> str:
        """What the path begins with."""
        parts = self.path.split(".")
        return ".".join(parts[:2] if parts[0] == "controller" else parts[:1])


@dataclass(frozen=True)
class SettingsCard:
    """The settings of a run, and what another one can begin with."""

    name: str
    settings: tuple[Setting, ...]
    robot: str
    world: str
    seed: int
    robots: tuple[str, ...]
    worlds: tuple[str, ...]
    examples: tuple[str, ...]
    why_not: str


def text_of(value: Any) -> str:
    """Returns a plain value as the text that YAML has for it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, list):
        return f"[{', '.join(map(text_of, value))}]"
    return str(value)


SHOWN = 40
"""Greatest number of settings that are listed at once."""


def matching(
    settings: tuple[Setting, ...], words: str, pending: dict[str, Any], changed: bool
) -> list[Setting]:
    """Returns the settings whose path or text has all words."""
    wanted = words.lower().split()
    return [
        one
        for one in settings
        if all(word in f"{one.path} {one.text}".lower() for word in wanted)
        and (not changed or one.path in pending or one.value != one.usual)
    ]
