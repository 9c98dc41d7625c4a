"""Writes a scenario as the YAML file that has what differs from the defaults alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydrake.common.yaml import yaml_dump

from atlas_drake.config import as_plain
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario.scenario import Scenario
from atlas_drake.scenario.time_grid import nominal_period
from atlas_drake.scenario.world_file import load_world

ALWAYS = ("name", "model", "duration", "seed")
"""Fields that are written in any case."""


def scenario_yaml(scenario: Scenario) -> str:
    """Returns a file that ``load_scenario`` reads as this scenario."""
    return str(yaml_dump(changed_fields(scenario)))


def changed_fields(scenario: Scenario) -> dict[str, Any]:
    """Returns the fields that differ from the defaults of the robot, as in YAML.

    Args:
        scenario: A resolved scenario.
    """
    plain = as_plain(scenario)
    changed = _difference(plain, usual_of(scenario))
    if "world" in changed:
        changed["world"] = _brief_world(plain["world"])
    written = {*ALWAYS, *changed}
    return {one: changed.get(one, plain[one]) for one in plain if one in written}


def usual_of(scenario: Scenario) -> dict[str, Any]:
    """Returns all fields as they would be for the robot without a scenario."""
    usual = as_plain(Scenario(model=scenario.model).resolved())
    usual["control_period"] = nominal_period(scenario.physics_step)
    usual["plant"]["time_step"] = scenario.physics_step
    return dict(usual)


def _difference(value: Any, usual: Any) -> Any:
    """Returns what differs: within mappings what is below, or else all."""
    if not (isinstance(value, Mapping) and isinstance(usual, Mapping)):
        return value
    return {
        name: _difference(inner, usual.get(name))
        for name, inner in value.items()
        if name not in usual or inner != usual[name]
    }


def _brief_world(world: Mapping[str, Any]) -> Any:
    """Returns the name alone of a world that is as its file says."""
    try:
        return world["name"] if as_plain(load_world(world["name"])) == world else world
    except ScenarioError:
        return world
