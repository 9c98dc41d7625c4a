"""Makes scenarios from YAML files, fields and settings by path.

What a value may be is checked where the scenario is declared.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from atlas_drake.config import as_plain, checked, read_fields, read_file, read_yaml
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario.scenario import Scenario
from atlas_drake.worlds.world_file import with_full_paths, world_fields

_PART = re.compile(r"([^.\[\]]+)((?:\[\d+\])*)")


def load_scenario(path: str | Path) -> Scenario:
    """Reads and validates one YAML file; fields left out have their defaults.

    Args:
        path: Path of the file.

    Raises:
        ScenarioError: If the file cannot be read, has unknown keys or bad values.
    """
    try:
        raw = read_fields(read_file(path), "duration: 10")
        return scenario_from(with_full_paths(raw, Path(path).parent))
    except ScenarioError as error:
        raise error.within(path) from None


def scenario_from(
    fields: Mapping[str, Any], default: Scenario | None = None
) -> Scenario:
    """Makes a scenario from the fields of a YAML file; others are the default's."""
    base = Scenario() if default is None else default.validate()
    if "world" in fields:
        fields = {**fields, "world": world_fields(fields["world"])}
    made: Scenario = checked(Scenario, fields, base=base)
    return made


def with_settings(scenario: Scenario, settings: Iterable[str]) -> Scenario:
    """Returns a scenario with settings as ``pushes[0].impulse=30``; the last counts."""
    values: dict[str, Any] = {}
    for setting in settings:
        path, equals, text = setting.partition("=")
        if not (equals and is_path(path)):
            raise ScenarioError.about("--set", setting, "must be KEY.PATH=VALUE")
        try:
            value = read_yaml(text)
        except ValueError as error:
            problem = f"must be a value as in YAML: {error}"
            raise ScenarioError.about(path, text, problem) from None
        values.pop(path, None)
        values[path] = value
    return with_values(scenario, values)


def with_values(scenario: Scenario, values: Mapping[str, Any]) -> Scenario:
    """Returns a scenario with values by path, as YAML has them, one after the other."""
    fields: dict[str, Any] = {}
    known = replace(scenario, controller=scenario.controller_config())
    for path, value in values.items():
        _put(fields, path, value, known)
    return scenario_from(fields, scenario)


def is_path(text: str) -> bool:
    """Returns True if a text is a path of a field, such as ``pushes[0].impulse``."""
    return all(_PART.fullmatch(part.strip()) for part in text.split("."))


def _put(fields: dict[str, Any], path: str, value: Any, base: Any) -> None:
    """Puts a value at a path into ``fields``, which change the structure ``base``.

    The fields are as in a YAML file. A list among them is whole: before one of its
    elements changes, the list is taken from ``base``.
    """
    if not is_path(path):
        raise ScenarioError.about(path, path, "must be a path, as pushes[0].impulse")
    parts: list[str | int] = []
    for name, places in _PART.findall(path):
        parts += [name.strip(), *map(int, re.findall(r"\d+", places))]
    place: Any = fields
    for part, following in itertools.pairwise(parts):
        if isinstance(part, int):
            base, inner = None, _element(place, part, path)
        else:
            base, inner = getattr(base, part, None), place.get(part)
        if isinstance(following, int):
            if not isinstance(inner, list):
                inner = as_plain(base) if isinstance(base, list | tuple) else []
        elif not isinstance(inner, dict):
            # A world that is given as a text has it as its name.
            named = part == "world" and isinstance(inner, str)
            inner = {"name": inner} if named else {}
        place[part] = inner
        place = inner
    if isinstance(parts[-1], int):
        _element(place, parts[-1], path)
    place[parts[-1]] = value


def _element(items: list[Any], place: int, path: str) -> Any:
    if place >= len(items):
        problem = f"there is no [{place}] of {len(items)} elements; give the whole list"
        raise ScenarioError(path, place, problem)
    return items[place]
