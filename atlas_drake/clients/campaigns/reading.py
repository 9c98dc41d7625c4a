"""Campaigns from YAML files.

The key ``scenario`` holds a path or fields. ``pushes``, ``duration`` and ``schedule``
may stand beside it; numbers of a push may be distributions.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from atlas_drake.clients.campaigns.campaign import PARAMETERS, Campaign
from atlas_drake.clients.campaigns.distributions import is_distribution
from atlas_drake.config import checked, read_fields, read_file, read_yaml
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario import (
    Scenario,
    load_scenario,
    scenario_from,
    with_settings,
    with_values,
)
from atlas_drake.worlds.world_file import with_full_paths

BESIDE = ("pushes", "duration", "schedule")
"""Fields of the scenario that may stand beside ``scenario``."""


def load_campaign(
    path: str | Path,
    settings: Iterable[str] = (),
    overrides: Mapping[str, Any] | None = None,
) -> Campaign:
    """Reads and validates one YAML file; omitted fields have their defaults.

    Args:
        path: Path of the file.
        settings: Values as for ``--set``, also of parameters, such as
            ``parameters.direction=left``. They replace distributions and cases.
        overrides: Fields of the scenario by path, as ``with_values`` takes them.

    Raises:
        ScenarioError: If the file cannot be read, has unknown keys or bad values.
    """
    try:
        raw = read_fields(read_file(path), "trials: 100")
        return _campaign(raw, Path(path).parent, list(settings), overrides or {})
    except ScenarioError as error:
        raise error.within(path) from None


def is_campaign(path: str | Path) -> bool:
    """Returns True if a YAML file of fields has any that only a campaign has."""
    campaign, scenario = (
        {field.name for field in dataclasses.fields(kind)}
        for kind in (Campaign, Scenario)
    )
    return not (campaign - scenario).isdisjoint(
        read_fields(read_file(path), "duration: 5.0")
    )


def _campaign(
    raw: Mapping[str, Any],
    folder: Path,
    settings: list[str],
    overrides: Mapping[str, Any],
) -> Campaign:
    """Makes a campaign from the fields of a YAML file in a folder."""
    fields = dict(raw)
    scenario = _scenario(fields.pop("scenario", None), folder)
    beside = {name: fields.pop(name) for name in BESIDE if name in fields}
    drawn = _take_distributions(beside)
    if beside:
        scenario = scenario_from(beside, scenario)
    scenario = with_values(scenario, overrides)
    given = [text.partition("=") for text in settings]
    own = [parts for parts in given if _is_parameter(*parts)]
    others = ["".join(parts) for parts in given if parts not in own]
    scenario = with_settings(scenario, others)
    parameters = {path.removeprefix(PARAMETERS): _value(path, v) for path, _, v in own}
    for name, more in (("parameters", parameters), ("vary", drawn)):
        if more and isinstance(fields.setdefault(name, {}), Mapping):
            for path in drawn.keys() & fields[name]:
                problem = "is drawn in pushes already"
                raise ScenarioError(f"vary.{path}", fields[name][path], problem)
            fields[name] = {**fields[name], **more}
    fixed = {path for path, *_ in given} | overrides.keys()
    for name in ("vary", "cases"):
        if isinstance(fields.get(name), Mapping):
            varied = fields[name].items()
            fields[name] = {path: item for path, item in varied if path not in fixed}
    code = fields.get("code", [])
    if isinstance(code, str | list):
        files = [code] if isinstance(code, str) else code
        fields["code"] = [str((folder / str(name)).absolute()) for name in files]
    base = Campaign(scenario=scenario)
    campaign: Campaign = checked(Campaign, fields, base=base)
    return campaign


def _scenario(given: Any, folder: Path) -> Scenario:
    if given is None:
        return Scenario()
    if isinstance(given, str):
        return load_scenario(folder / given)
    if not isinstance(given, Mapping):
        problem = "must be a scenario's file, or its fields"
        raise ScenarioError.about("scenario", given, problem)
    try:
        return scenario_from(with_full_paths(given, folder))
    except ScenarioError as error:
        name = f"scenario.{error.field}"
        raise ScenarioError(name, error.value, error.problem) from None


def _take_distributions(beside: dict[str, Any]) -> dict[str, Any]:
    """Takes the distributions out of the pushes, and returns them by path."""
    drawn: dict[str, Any] = {}
    pushes = beside.get("pushes")
    if not isinstance(pushes, list):
        return drawn  # The scenario refuses it.
    beside["pushes"] = plain = []
    for index, push in enumerate(pushes):
        fixed = push
        if isinstance(push, Mapping):
            random = [name for name in push if is_distribution(push[name])]
            drawn |= {f"pushes[{index}].{name}": push[name] for name in random}
            fixed = {name: push[name] for name in push if name not in random}
            if "time" in random:
                fixed["time"] = 0.0
        plain.append(fixed)
    return drawn


def _is_parameter(path: str, equals: str, _value: str) -> bool:
    return bool(equals) and path.startswith(PARAMETERS) and path != PARAMETERS


def _value(path: str, text: str) -> Any:
    """Reads the value of a parameter from the command line."""
    try:
        return read_yaml(text)
    except Exception as error:  # The parser raises many kinds of exception.
        problem = f"must be a value as in YAML: {error}"
        raise ScenarioError.about(path, text, problem) from error
