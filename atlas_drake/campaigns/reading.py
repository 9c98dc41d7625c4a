"""Campaigns from YAML files.

The key ``scenario`` holds a path or fields. ``pushes``, ``duration`` and ``schedule``
may stand beside it; numbers of a push may be distributions.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from atlas_drake.campaigns.campaign import PARAMETERS, Campaign
from atlas_drake.campaigns.distributions import is_distribution
from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.config import checked, read_yaml
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.scenario import (
    Scenario,
    load_scenario,
    scenario_from,
    with_settings,
    with_values,
)
from atlas_drake.scenario.world_file import with_full_paths

BESIDE = ("pushes", "duration", "schedule")
"""Fields of the scenario that may stand beside ``scenario``."""
_CAMPAIGN, _SCENARIO = (
    {field.name for field in dataclasses.fields(kind)} for kind in (Campaign, Scenario)
)
ONLY_CAMPAIGN = _CAMPAIGN - _SCENARIO
"""Fields of a campaign that no scenario has."""
ONLY_SCENARIO = _SCENARIO - _CAMPAIGN - set(BESIDE)
"""Fields of a scenario that must stand below ``scenario``."""


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
        raw = read_yaml(Path(path).read_text())
    except Exception as error:  # The parser raises many kinds of exception.
        problem = f"{path} cannot be read: {error}"
        raise CampaignError("file", str(path), problem) from error
    if not isinstance(raw, Mapping):
        raise CampaignError("file", raw, f"{path} must have fields of a campaign")
    try:
        return campaign_from(raw, Path(path).parent, settings, overrides)
    except ScenarioError as error:
        problem = f"{error.problem}{_where_drawn(error)} (in {path})"
        raise type(error)(error.field, error.value, problem) from None


def is_campaign(path: str | Path) -> bool:
    """Returns True if a YAML file of fields has any that only a campaign has."""
    raw = read_yaml(Path(path).read_text())
    return isinstance(raw, Mapping) and any(name in ONLY_CAMPAIGN for name in raw)


def campaign_from(
    raw: Mapping[str, Any],
    folder: Path,
    settings: Iterable[str] = (),
    overrides: Mapping[str, Any] | None = None,
) -> Campaign:
    """Makes a campaign from the fields of a YAML file.

    Args:
        raw: Fields as YAML reads them.
        folder: Folder that the paths in them are relative to.
        settings: As for ``load_campaign``.
        overrides: As for ``load_campaign``.

    Raises:
        ScenarioError: Naming the first field that cannot be used.
    """
    fields = dict(raw)
    for name, value in fields.items():
        if name in ONLY_SCENARIO:
            problem = (
                "is a field of scenarios; a campaign has it below `scenario`, and "
                "`atlas-drake run` takes a scenario's file"
            )
            raise CampaignError(name, value, problem)
    scenario = _scenario(fields.pop("scenario", None), folder)
    drawn: dict[str, Any] = {}
    beside = {name: fields.pop(name) for name in BESIDE if name in fields}
    if "pushes" in beside:
        beside["pushes"] = _pushes(beside["pushes"], drawn)
    if beside:
        scenario = scenario_from(beside, scenario)
    scenario = with_values(scenario, overrides or {})
    settings = list(settings)
    own = [text for text in settings if text.startswith(PARAMETERS)]
    scenario = with_settings(scenario, [text for text in settings if text not in own])
    if isinstance(fields.get("code"), str):
        fields["code"] = [fields["code"]]
    fields["vary"] = _joined(drawn, fields.get("vary"))
    fixed = {text.partition("=")[0] for text in settings} | set(overrides or {})
    for name in ("vary", "cases"):
        if isinstance(fields.get(name), Mapping):
            varied = fields[name].items()
            fields[name] = {path: item for path, item in varied if path not in fixed}
    base = Campaign(scenario=scenario)
    if not isinstance(fields.get("parameters", {}), Mapping):
        own = []  # The check refuses the parameters.
    for text in own:
        name, equals, value = text.removeprefix(PARAMETERS).partition("=")
        if not (name and equals):
            problem = f"is {shown(text)}; must be {PARAMETERS}NAME=VALUE"
            raise CampaignError("--set", text, problem)
        try:
            given = read_yaml(value)
        except Exception as error:  # The parser raises many kinds of exception.
            problem = f"must be a value as in YAML: {error}"
            raise CampaignError.about(PARAMETERS + name, value, problem) from error
        fields["parameters"] = {**fields.get("parameters", {}), name: given}
    if isinstance(fields.get("code"), list):
        fields["code"] = [
            str((folder / name).absolute()) if isinstance(name, str) else name
            for name in fields["code"]
        ]
    campaign: Campaign = checked(Campaign, fields, base=base)
    return campaign


def _where_drawn(error: ScenarioError) -> str:
    """Returns a hint if a distribution stands where a number belongs."""
    if not is_distribution(error.value):
        return ""
    path = error.field.removeprefix("scenario.")
    hint = f"; distributions belong below `vary`: `{path}: {shown(error.value)}`"
    return f"{hint}, or in `pushes` beside `scenario`" if "pushes[" in path else hint


def _scenario(given: object, folder: Path) -> Scenario:
    if given is None:
        return Scenario()
    if isinstance(given, str):
        return load_scenario(folder / given)
    if not isinstance(given, Mapping):
        problem = f"is {shown(given)}; must be a scenario's file, or its fields"
        raise CampaignError("scenario", given, problem)
    try:
        return scenario_from(with_full_paths(given, folder))
    except ScenarioError as error:
        name = f"scenario.{error.field}"
        raise CampaignError(name, error.value, error.problem) from None


def _pushes(given: object, drawn: dict[str, Any]) -> object:
    """Returns the pushes without their distributions, and adds these to ``drawn``."""
    if not isinstance(given, list):
        return given  # The scenario refuses it.
    pushes = []
    for index, push in enumerate(given):
        plain = dict(push) if isinstance(push, Mapping) else push
        if isinstance(plain, dict):
            for name, value in list(plain.items()):
                if is_distribution(value):
                    drawn[f"pushes[{index}].{name}"] = value
                    del plain[name]
            if f"pushes[{index}].time" in drawn:
                plain["time"] = 0.0
        pushes.append(plain)
    return pushes


def _joined(drawn: dict[str, Any], vary: object) -> object:
    if vary is None:
        return drawn
    if not isinstance(vary, Mapping):
        return vary  # The check refuses it.
    twice = set(drawn) & set(vary)
    if twice:
        name = min(twice)
        raise CampaignError(f"vary.{name}", vary[name], "is drawn in pushes already")
    return {**drawn, **vary}
