"""In what scenarios differ: from each other, and from the defaults, written as YAML."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydrake.common.yaml import yaml_dump

from atlas_drake.config import as_plain, joined
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario.physics import nominal_period
from atlas_drake.scenario.scenario import Scenario
from atlas_drake.worlds.world_file import load_world

OF_A_RUN = (
    "name",
    "duration",
    "seed",
    "jitter",
    "friction_jitter",
    "ground_friction",
    "pushes",
    "start.position",
    "start.yaw",
    "start.release_time",
)
"""Fields that matter only when a run begins or while it goes on. All others are built
into the diagram: the robot, the steps, the controller's numbers, the world."""
ALWAYS = ("name", "model", "duration", "seed")
"""Fields that are written to YAML in any case."""


def is_of_a_run(path: str) -> bool:
    """Returns True if the field of a path matters to a run alone."""
    return any(path == one or path.startswith(f"{one}.") for one in OF_A_RUN)


def built_in_difference(one: Scenario, other: Scenario) -> str | None:
    """Path of the first field in which the diagrams of two scenarios differ, if any."""
    ours, theirs = flat(as_plain(one)), flat(as_plain(other))
    for path in {**ours, **theirs}:
        if not is_of_a_run(path) and ours.get(path) != theirs.get(path):
            return path
    return None


def flat(value: Any, path: str = "") -> dict[str, Any]:
    """Returns the values within mappings by their path; lists are values."""
    if not isinstance(value, Mapping):
        return {path: value}
    found: dict[str, Any] = {}
    for name, item in value.items():
        found |= flat(item, joined(path, name))
    return found


def scenario_yaml(scenario: Scenario) -> str:
    """Returns a file that ``load_scenario`` reads as this scenario."""
    return str(yaml_dump(changed_fields(scenario)))


def changed_fields(scenario: Scenario) -> dict[str, Any]:
    """Returns the fields of a resolved scenario that differ from its robot's usual."""
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
    """Returns what differs: of mappings the entries that do, of others the value."""
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
