"""Checks of a reset and of a new run in a simulation that is built already."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from atlas_drake.checked import as_plain, checked, joined
from atlas_drake.errors import ScenarioError
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.scenario import starting_behavior

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


def start_of_reset(
    scenario: Scenario,
    catalog: BehaviorCatalog,
    behavior: Behavior | int | str | None,
    pose: Start | None,
) -> tuple[Behavior, Start]:
    """Returns behavior and start of a reset; None is the scenario's.

    Raises:
        InvalidMessageError: If the robot cannot begin with that behavior.
        ScenarioError: If it cannot begin in that pose.
    """
    asked = scenario.initial_behavior if behavior is None else behavior
    begin = starting_behavior(asked, "behavior", catalog)
    start: Start = checked(Start, scenario.start if pose is None else pose, "pose")
    start.check_behavior(begin)
    if start.harnessed and not scenario.start.harnessed:
        raise ScenarioError(
            "start.harnessed", True, "needs a scenario that began in a harness"
        )
    return begin, start


def check_restart(present: Scenario, asked: Scenario) -> None:
    """Checks that the diagram of a scenario can simulate another scenario.

    Raises:
        ScenarioError: Naming a field that needs a new diagram.
    """
    field = built_in_difference(present, asked)
    if field is not None:
        raise ScenarioError(field, None, "is changed, and needs a new simulation")


def built_in_difference(one: Scenario, other: Scenario) -> str | None:
    """Path of the first field in which the diagrams of two scenarios differ, if any."""
    ours, theirs = flat(as_plain(one)), flat(as_plain(other))
    for path in {**ours, **theirs}:
        of_a_run = any(path == f or path.startswith(f"{f}.") for f in OF_A_RUN)
        if not of_a_run and ours.get(path) != theirs.get(path):
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
