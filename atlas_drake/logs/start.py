"""Begins a log: file, header and recorder of one scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pydrake.common.yaml import yaml_dump

from atlas_drake.logs.formats import LogFile
from atlas_drake.logs.notes import Header
from atlas_drake.logs.recorder import LogRecorder
from atlas_drake.logs.samples import RowSampler
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.kinds import as_plain


def start_recorder(
    path: Path, scenario: Scenario, robot: Robot, tick_seconds: Sequence[float]
) -> LogRecorder:
    """Opens the file and makes the system that fills it.

    Args:
        path: Of the file; its ending says in which format.
        scenario: That is simulated.
        robot: In the scenario.
        tick_seconds: Wall times of the controller's ticks, which it appends to.

    Raises:
        LogError: If the file cannot be written.
    """
    sampler = RowSampler(robot)
    period = scenario.control_period
    header = Header(robot.name, period, yaml_dump(as_plain(scenario)), sampler.layout)
    return LogRecorder(sampler, LogFile(path, header), period, tick_seconds)
