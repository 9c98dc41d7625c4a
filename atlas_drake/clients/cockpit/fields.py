"""Describes the fields of a configuration to the page, from their declarations.

One description serves all forms: the settings of a scenario, the parameters of a
behavior.
"""

from __future__ import annotations

import types
import typing
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any

from annotated_types import Ge, Gt, Interval, Le, Lt

from atlas_drake.config import as_plain, fields_of, joined, trailing_strings
from atlas_drake.robot.load import available_robots, imported_robots
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.differences import is_of_a_run, usual_of
from atlas_drake.units import unit_of
from atlas_drake.worlds.world_file import available_worlds

NOT_LISTED = (
    "name",
    "model",  # It has a choice of its own, as have the world and what is a list.
    "world",
    "messages",
    "terrain",
    "models",
    "pushes",
    "plant.time_step",
    "plant.use_sampled_output_ports",
    "simulator.start_time",
)
"""Paths that are no settings of the list, with all below them."""
EXAMPLES = Path(__file__).parents[3] / "examples" / "scenarios"
"""Scenarios beside the package; an installed package has none."""


def settings_of(scenario: Scenario, why_not: str) -> dict[str, Any]:
    """Describes a resolved scenario; ``why_not`` says why no other can follow."""
    return {
        "name": scenario.name,
        "robot": scenario.model,
        "world": scenario.surroundings().name,
        "seed": scenario.seed,
        "robots": _robots(scenario),
        "worlds": available_worlds(),
        "examples": sorted(path.stem for path in EXAMPLES.glob("*.yaml")),
        "why_not": why_not,
        "fields": list(scenario_fields(scenario)),
    }


def _robots(scenario: Scenario) -> list[list[str]]:
    """Returns value and label of the robots that can be chosen.

    Beside those that come along, these are what was imported into the working folder
    or into the folder of the present robot.
    """
    shipped = available_robots()
    beside = [Path.cwd()]
    if scenario.model not in shipped:
        beside.append(Path(scenario.model).absolute().parents[1])
    imported = imported_robots(*beside).items()
    return [
        *([name, name] for name in shipped),
        *([str(path), f"{name} (imported)"] for name, path in imported),
    ]


def scenario_fields(scenario: Scenario) -> Iterator[dict[str, Any]]:
    """Lists all fields of a resolved scenario that are one value each."""
    yield from _within(Scenario, scenario, usual_of(scenario), "", NOT_LISTED)


def param_fields(kind: type) -> list[dict[str, Any]]:
    """Lists the parameters of a behavior, whose class has defaults."""
    blank = kind()
    return list(_within(kind, blank, as_plain(blank), "", ()))


def _within(
    kind: Any, value: Any, usual: Any, path: str, left_out: Collection[str]
) -> Iterator[dict[str, Any]]:
    """Lists the fields of a value of some kind, whose path is given."""
    told = trailing_strings(kind)
    for name, declared in fields_of(kind).items():
        place = joined(path, name)
        if place in left_out:
            continue
        inner = getattr(value, name)
        known = usual.get(name) if isinstance(usual, dict) else None
        if fields_of(inner.__class__):
            yield from _within(inner.__class__, inner, known, place, left_out)
        else:
            yield _field(place, declared, as_plain(inner), known, told.get(name, ""))


def _field(
    path: str, declared: Any, value: Any, usual: Any, text: str
) -> dict[str, Any]:
    parts = list(_parts(declared))
    choices = [
        str(choice)
        for part in parts
        if typing.get_origin(part) is typing.Literal
        for choice in typing.get_args(part)
    ]
    unit = unit_of(declared)
    return {
        "path": path,
        "value": text_of(value),
        "usual": text_of(usual),
        "text": " ".join(text.replace("``", "").split()),
        "unit": unit if unit and unit != "-" else "",
        "kind": "choice" if choices else _kind(value),
        "bounds": bounds_in_words(parts),
        "choices": choices,
        "needs": "a new run" if is_of_a_run(path) else "a restart",
    }


def _kind(value: Any) -> str:
    kinds = ((bool, "flag"), (int | float, "number"), (str, "text"))
    return next((name for kind, name in kinds if isinstance(value, kind)), "yaml")


def text_of(value: Any) -> str:
    """Returns a plain value as the text that YAML has for it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, list):
        return f"[{', '.join(map(text_of, value))}]"
    return str(value)


def _parts(declared: Any) -> Iterator[Any]:
    """Takes annotations and unions apart: types and notes."""
    if typing.get_origin(declared) is Annotated:
        inner, *notes = typing.get_args(declared)
        yield from (*_parts(inner), *notes)
    elif typing.get_origin(declared) in (types.UnionType, typing.Union):
        for one in typing.get_args(declared):
            yield from _parts(one)
    else:
        yield declared


def bounds_in_words(notes: Iterable[Any]) -> str:
    """Says what a number may be, such as "> 0, ≤ 1"; empty without bounds."""
    said = []
    for note in notes:
        for sign, kind, name in (
            (">", Gt, "gt"),
            ("≥", Ge, "ge"),
            ("<", Lt, "lt"),
            ("≤", Le, "le"),
        ):
            if isinstance(note, kind | Interval):
                bound = getattr(note, name)
                said += [] if bound is None else [f"{sign} {bound:g}"]
    return ", ".join(said)
