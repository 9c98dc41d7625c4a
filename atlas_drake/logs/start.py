"""Starts a log: file, header and recorder of one scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pydrake.common.yaml import yaml_dump

from atlas_drake.checked import as_plain
from atlas_drake.logs.formats import LogFile
from atlas_drake.logs.notes import Header
from atlas_drake.logs.recorder import LogRecorder
from atlas_drake.logs.rows import RowMaker
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.time_grid import on_common_grid
from atlas_drake.scenario.world import WorldMaker


def start_recorder(
    path: Path,
    scenario: Scenario,
    robot: Robot,
    world: Sequence[WorldMaker],
    tick_seconds: Sequence[float],
    behaviors: Sequence[BehaviorInterface] = (),
) -> LogRecorder:
    """Opens the file and makes the system that writes it.

    Args:
        path: Path of the file; its ending selects the format.
        scenario: The simulated scenario.
        robot: Robot of the scenario.
        world: Models in the plant beside the robot.
        tick_seconds: Wall times of the controller's ticks, which it appends to.
        behaviors: The user's own behaviors, beside the shipped ones.

    Raises:
        LogError: If the file cannot be written.
    """
    maker = RowMaker(robot, world)
    nominal = scenario.control_period
    _, period = on_common_grid(scenario.physics_step, nominal)
    text = yaml_dump(as_plain(scenario))
    header = Header(robot.model, nominal, text, maker.layout, tuple(behaviors))
    return LogRecorder(maker, LogFile(path, header), period, tick_seconds)
