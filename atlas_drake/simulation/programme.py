"""The commands that a scenario sends: the tutorial's, and messages of its own."""

from __future__ import annotations

from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.simulation.tutorial import control_mode_switch_programme
from atlas_drake.systems.command_scheduler import ScheduledCommand


def scheduled_programme(
    scenario: Scenario, robot: Robot, catalog: BehaviorCatalog = SHIPPED
) -> tuple[ScheduledCommand, ...]:
    """Return the commands that a scenario sends by itself, in order of time.

    Args:
        scenario: With a programme, messages, both or neither.
        robot: Who gets them.
        catalog: The behaviors that can be asked for.

    Raises:
        ScenarioError: If the robot lacks joints that the programme commands, or would
            refuse a message.
    """
    programme = []
    if scenario.programme != "none":
        literal = scenario.programme == "tutorial_literal"
        programme = control_mode_switch_programme(robot, literal)
    for index, entry in enumerate(scenario.messages):
        message = entry.message(robot.joint_names, f"messages[{index}]", catalog)
        text = entry.text or f"[{_kind(message, catalog)}]"
        programme.append(ScheduledCommand(entry.time, message, text))
    return tuple(sorted(programme, key=lambda entry: entry.time))


def _kind(
    message: AtlasCommand | AtlasSimInterfaceCommand, catalog: BehaviorCatalog
) -> str:
    """Returns the text of an event for a message without a text of its own."""
    if isinstance(message, AtlasCommand):
        return "joint command"
    return catalog.find(message.behavior, "behavior").name
