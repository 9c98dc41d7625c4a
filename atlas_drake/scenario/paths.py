"""Paths of a scenario's fields, such as ``pushes[0].impulse``: values put by them.

What a value may be is checked where the scenario is made.
"""

from __future__ import annotations

import itertools
import re
from typing import Any

from atlas_drake.config import as_plain
from atlas_drake.errors import ScenarioError, shown

_PART = re.compile(r"([^.\[\]]+)((?:\[\d+\])*)")


def is_path(text: str) -> bool:
    """Tells whether a text is a path of a field."""
    return all(_PART.fullmatch(part.strip()) for part in text.split("."))


def parts_of(path: str) -> list[str | int]:
    """Splits a path into names of fields and places in lists.

    Raises:
        ScenarioError: If it is no path.
    """
    parts: list[str | int] = []
    for text in path.split("."):
        found = _PART.fullmatch(text.strip())
        if found is None:
            problem = f"is {shown(path)}; must be a path such as pushes[0].impulse"
            raise ScenarioError(path, path, problem)
        parts.append(found[1])
        parts += [int(place) for place in re.findall(r"\d+", found[2])]
    return parts


def put(fields: dict[str, Any], path: str, value: Any, base: Any) -> None:
    """Puts a value into the fields that change a structure.

    Args:
        fields: As YAML has them; changed. A list in them is whole: it is taken from
            ``base`` before an element is changed.
        path: Where to.
        value: As YAML has it.
        base: The structure with the fields that are left out.

    Raises:
        ScenarioError: If the path leads nowhere in a list.
    """
    parts = parts_of(path)
    place: Any = fields
    for part, following in itertools.pairwise(parts):
        if isinstance(part, int):
            base = None
            inner = _element(place, part, path)
        else:
            base = getattr(base, part, None)
            inner = place.get(part)
        if isinstance(following, int):
            if not isinstance(inner, list):
                inner = as_plain(base) if isinstance(base, list | tuple) else []
        elif not isinstance(inner, dict):
            # Of a world its name alone may have been given before.
            named = part == "world" and isinstance(inner, str)
            inner = {"name": inner} if named else {}
        place[part] = inner
        place = inner
    last = parts[-1]
    if isinstance(last, int):
        _element(place, last, path)
    place[last] = value


def _element(items: list[Any], place: int, path: str) -> Any:
    if place >= len(items):
        problem = (
            f"there is no [{place}]: the list has {len(items)} elements; give the "
            "whole list"
        )
        raise ScenarioError(path, place, problem)
    return items[place]
