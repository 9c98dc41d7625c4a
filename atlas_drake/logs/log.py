"""A log in memory, independent of the file format.

``figures`` draws a log, ``diagrams.replay`` replays it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from pydrake.common.yaml import yaml_load

from atlas_drake.errors import RobotDescriptionError, did_you_mean
from atlas_drake.logs.formats import read_file
from atlas_drake.logs.notes import (
    COMMANDS,
    EVENT,
    Header,
    LogError,
    Note,
    event_from_note,
)
from atlas_drake.messages import Behavior, Message
from atlas_drake.messages.event import Event
from atlas_drake.messages.plain import message_from
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario, scenario_from

TINY = 1e-6
"""Norm of a quaternion below which it gives no orientation."""
NUMBERS = "biuf"
"""Numpy's kinds of data types that a channel can have."""


@dataclass(frozen=True)
class LoggedCommand:
    """A command as it was sent, also one that was refused.

    Attributes:
        time: Time of the control tick that read the command first [s].
        message: An ``AtlasCommand`` or ``AtlasSimInterfaceCommand``.
    """

    time: float
    message: Message


@dataclass(frozen=True)
class Log:
    """The record of a run.

    Example:
        >>> log = read_log("run.mcap")
        >>> knee = log.robot.joint_index("l_leg_kny")
        >>> log.time, log["joints.effort"][:, knee]

    Attributes:
        path: File of the log.
        header: Facts about the log as a whole.
        arrays: Channels by name, shape (rows,) or (rows, elements); names, units and
            labels are in ``header.layout.channels``.
        notes: Commands and events in the order of writing.
    """

    path: Path
    header: Header
    arrays: dict[str, np.ndarray]
    notes: list[Note]

    def __getitem__(self, name: str) -> np.ndarray:
        """A channel.

        Raises:
            KeyError: If the log has no such channel.
        """
        if name not in self.arrays:
            raise KeyError(
                f"the log has no channel {name!r}.{did_you_mean(name, self.arrays)} "
                f"It has {', '.join(self.arrays)}."
            )
        return self.arrays[name]

    def column(self, name: str, label: str) -> np.ndarray:
        """One element of a channel, by its label.

        Example:
            >>> log.column("world.v", "ball_ball_vx")

        Args:
            name: Name of the channel.
            label: Label of the element, such as ``x``, a joint or a coordinate.

        Returns:
            Shape (rows,).

        Raises:
            KeyError: If the log has no such channel, or the channel no such element.
        """
        array = self[name]
        channels = self.header.layout.channels
        labels = next(entry.labels for entry in channels if entry.name == name)
        if label not in labels:
            raise KeyError(
                f"{name} has no element {label!r}.{did_you_mean(label, labels)} It has "
                f"{', '.join(labels) or 'a single number'}."
            )
        return array[:, labels.index(label)]

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    @property
    def time(self) -> np.ndarray:
        """Times of the rows [s], shape (rows,); never decreasing."""
        return self["time"]

    @cached_property
    def events(self) -> list[Event]:
        """Events in order of time."""
        events = [event_from_note(note) for note in self.notes if note.kind == EVENT]
        return sorted(events, key=lambda event: event.time)

    @cached_property
    def commands(self) -> list[LoggedCommand]:
        """The commands as they were sent, in order."""
        return [
            LoggedCommand(note.time, message_from(COMMANDS[note.kind], note.data))
            for note in self.notes
            if note.kind in COMMANDS
        ]

    def behavior(self, number: int) -> Behavior:
        """Returns the behavior of a number in the channel ``behavior.current``.

        Args:
            number: Number in that channel.

        Raises:
            ValueError: If the run had no such behavior.
        """
        return self.header.catalog.find(number)

    @cached_property
    def robot(self) -> Robot:
        """The robot that was simulated.

        Raises:
            LogError: If the robot is unknown, its files are missing, or its joints have
                changed since the run.
        """
        try:
            robot = load_robot(self.header.model)
        except RobotDescriptionError as error:
            raise LogError(
                f"{self.path}: its robot cannot be loaded: {error}"
            ) from error
        for channel in self.header.layout.channels:
            of_joints = channel.name == "joints.k_effort"
            if of_joints and channel.labels != robot.joint_names:
                raise LogError(
                    f"{self.path}: its robot, {self.header.model}, has other joints "
                    "than when the log was recorded; restore its file of that time"
                )
        return robot

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario that was simulated.

        Raises:
            LogError: If this version of the program cannot run the scenario.
        """
        try:
            return scenario_from(yaml_load(data=self.header.scenario))
        except Exception as error:
            # The loader raises many kinds of exception.
            raise LogError(f"{self.path}: its scenario is unknown: {error}") from error


def read_log(path: str | Path) -> Log:
    """Reads a log in the format of its file name ending.

    An incomplete .mcap file is read up to the last complete message.

    Args:
        path: Path of the file: .mcap, .npz or .parquet.

    Raises:
        LogError: If the file cannot be read, is not a log, is damaged, or has no rows.
    """
    path = Path(path)
    log = Log(path, *read_file(path))
    try:
        _check_sound(log)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise LogError(f"{path}: it is damaged: {error}") from error
    if not len(log):
        raise LogError(f"{path}: it has no rows; the run ended before its first tick")
    return log


def _check_sound(log: Log) -> None:
    """Checks that a log can have been written by this program.

    Raises:
        ValueError: Or another error of values, if the log is inconsistent.
    """
    rows = len(log)
    for channel in log.header.layout.channels:
        array = log[channel.name]
        shape = (rows, channel.size) if channel.labels else (rows,)
        if array.shape != shape or array.dtype.kind not in NUMBERS:
            raise ValueError(f"{channel.name} is {array.dtype} of shape {array.shape}")
    if not (np.isfinite(log.time).all() and (np.diff(log.time) >= 0.0).all()):
        raise ValueError("time is not finite or decreases")
    if not 0.0 < log.header.control_period < np.inf:
        raise ValueError(f"control_period is {log.header.control_period}")
    q = log.arrays.get("state.q", np.ones((0, 4)))
    # The first four positions are the quaternion of the pelvis.
    if not (np.isfinite(q).all() and (np.linalg.norm(q[:, :4], axis=1) > TINY).all()):
        raise ValueError("state.q is not a pose")
    for behavior in np.unique(log.arrays.get("behavior.current", [])):
        log.behavior(int(behavior))
    # Both are made from the notes on first access, which checks the notes.
    _ = log.events, log.commands
