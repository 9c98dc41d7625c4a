"""What the page knows of the settings of a scenario: plain values, sent once a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Setting:
    """One field of a scenario.

    Attributes:
        path: Path of the field, such as ``controller.gains.dcm_gain``.
        value: Its value in the present run, as in YAML.
        usual: The value that the robot has without a scenario.
        text: What it is.
        unit: Its unit; empty without one.
        kind: number, flag, choice, or yaml for all else.
        bounds: What the number may be, in words; empty without bounds.
        choices: What the value may be, where there is a choice.
        needs: What a change needs: "a new run", or "a restart", which builds the
            simulation anew.
    """

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
    """The settings of a run, and what another one can begin with.

    Attributes:
        name: Name of the scenario.
        settings: Its fields.
        robot: Name or file of the robot.
        world: Name or file of the world.
        seed: Seed of the run.
        robots: Names of the known robots.
        worlds: Names of the known worlds.
        examples: Names of the known scenarios.
        why_not: Why no other simulation can be started; empty if one can.
    """

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
    """Returns the settings whose path or text has all words.

    Args:
        settings: All settings.
        words: Words to search for.
        pending: Values by path that wait for a restart.
        changed: True for those alone that differ from the usual, or wait.
    """
    wanted = words.lower().split()
    return [
        one
        for one in settings
        if all(word in f"{one.path} {one.text}".lower() for word in wanted)
        and (not changed or one.path in pending or one.value != one.usual)
    ]
