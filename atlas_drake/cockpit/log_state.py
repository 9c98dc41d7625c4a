"""What the page shows of a log: its card, and the state at a row."""

from __future__ import annotations

import numpy as np

from atlas_drake.cockpit.card import joint_cards
from atlas_drake.cockpit.observe import state_of
from atlas_drake.cockpit.state import BehaviorCard, LogCard, RunCard, RunState
from atlas_drake.frozen import replace
from atlas_drake.logs.log import Log
from atlas_drake.visualization.overlays import OVERLAYS, logged_overlays

REFUSAL = "A log is shown: it can be played, not commanded"
"""Why no command is carried out."""


def card_of_log(log: Log, meshcat_port: int) -> RunCard:
    """Makes the card of a log, whose 3D view is on a port."""
    robot, sole = log.robot, log.robot.file.sole
    return RunCard(
        title=log.path.name,
        robot=robot.name,
        mass=robot.mass,
        joints=joint_cards(robot),
        behaviors=tuple(
            BehaviorCard(entry.name, entry.color, entry.description, own=False)
            for entry in log.header.catalog
            if entry.name != "NONE"
        ),
        gait={},
        pelvis={},
        pushed=(),
        overlays={name: OVERLAYS[name] for name in logged_overlays(log.scenario.log)},
        sole=(sole.length, sole.width),
        meshcat_port=meshcat_port,
        columns=log.units,
        log=LogCard(float(log.time[0]), float(log.time[-1]), _phases(log)),
    )


def _phases(log: Log) -> tuple[tuple[float, str], ...]:
    """Returns when each behavior began [s]."""
    numbers = log["behavior.current"]
    begins = np.flatnonzero(np.diff(numbers, prepend=-1))
    return tuple(
        (float(log.time[row]), log.behavior(int(numbers[row])).name) for row in begins
    )


def user_share(log: Log, rows: np.ndarray) -> np.ndarray:
    """Returns the user's share of all joints at some rows, 0 to 1."""
    share: np.ndarray = log["joints.k_effort"][rows].mean(axis=1) / 255.0
    return share


def state_of_log(log: Log, row: int) -> RunState:
    """Reads the state at a row of a log."""
    catalog = log.header.catalog
    refusals = {entry.name: REFUSAL for entry in catalog}
    return replace(state_of(log.record(row), catalog), refusals=refusals)
