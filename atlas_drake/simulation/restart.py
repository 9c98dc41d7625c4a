"""Checks of a reset and of a new run in a simulation that is built already."""

from __future__ import annotations

from atlas_drake.config import checked
from atlas_drake.errors import ScenarioError
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.differences import built_in_difference
from atlas_drake.scenario.scenario import starting_behavior


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
    if start.on_gantry and not scenario.start.on_gantry:
        raise ScenarioError(
            "start.on_gantry", True, "needs a scenario that began on a gantry"
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
