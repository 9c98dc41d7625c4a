"""The parts of a log besides its rows: header, commands as sent, and events.

Conversion to plain data and back; the format files read and write files.
"""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from atlas_drake.errors import AtlasError, shown
from atlas_drake.logs.layout import Layout
from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand, Message
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.messages.controller_status import (
    ControllerStatus,
    Plan,
    PlannedPaths,
)
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.numeric import is_whole

FORMAT, VERSION = "atlas_drake log", 1
SHOWN = ("name", "number", "caption", "color", "description")
"""Fields of a user's own behavior that a log holds."""
COMMANDS: dict[str, type[Message]] = {
    "atlas_command": AtlasCommand,
    "atlas_sim_interface_command": AtlasSimInterfaceCommand,
}
"""Kinds of notes that are commands."""
EVENT = "event"
"""Kind of the notes that are events."""
PATHS = "planned_paths"
"""Kind of the notes that hold ``PlannedPaths``."""
FEEDBACK = "feedback"
"""Kind of the notes that hold the feedback of a user's own behavior."""
FOOTSTEPS = "footsteps"
"""Key in a note of PATHS: the footsteps to come, each as index, foot, x, y, z [m], yaw
[rad]."""
PATH_GRID = 1e-4
"""Resolution to which points of paths are rounded [m]."""


class LogError(AtlasError):
    """A log that cannot be written, read, drawn or replayed."""


@dataclass(frozen=True)
class Note:
    """A record that is not written in every tick, as plain data.

    Attributes:
        time: Time of the record [s].
        kind: One of COMMANDS, EVENT, PATHS, or FEEDBACK.
        data: Values that a JSON object can hold.
    """

    time: float
    kind: str
    data: dict[str, Any]


@dataclass(frozen=True)
class Header:
    """Facts about a log as a whole.

    Attributes:
        model: Name of the robot, or the path of its file.
        control_period: Time between rows [s].
        scenario: The scenario as YAML.
        layout: Layout of the rows.
        behaviors: The user's own behaviors, beside the shipped ones.
    """

    model: str
    control_period: float
    scenario: str
    layout: Layout
    behaviors: tuple[BehaviorInterface, ...] = ()

    @cached_property
    def catalog(self) -> BehaviorCatalog:
        """All behaviors of the run."""
        return BehaviorCatalog((*SHIPPED, *self.behaviors))

    def to_json(self) -> str:
        """Converts to text, with the format name that identifies a log."""
        return json.dumps(
            {
                "format": FORMAT,
                "version": VERSION,
                "model": self.model,
                "control_period": self.control_period,
                "scenario": self.scenario,
                "channels": self.layout.to_plain(),
                "behaviors": [
                    {name: getattr(entry, name) for name in SHOWN}
                    for entry in self.behaviors
                ],
            }
        )

    @classmethod
    def from_json(cls, text: str) -> Header:
        """The reverse of ``to_json``.

        Raises:
            LogError: If the text is not a header of a log, or has a later version.
        """
        try:
            plain = json.loads(text)
            if plain["format"] != FORMAT:
                raise LogError(f"its format is {plain['format']!r}, not {FORMAT!r}")
            if plain["version"] > VERSION:
                raise LogError(
                    f"its version is {plain['version']}, newer than this program"
                )
            return cls(
                str(plain["model"]),
                float(plain["control_period"]),
                str(plain["scenario"]),
                Layout.from_plain(plain["channels"]),
                tuple(
                    BehaviorInterface(**{name: entry[name] for name in SHOWN})
                    for entry in plain.get("behaviors", ())
                ),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise LogError("its header is invalid") from error


def checksum(*texts: str) -> str:
    """Returns a checksum, for what the checksums of a format do not cover."""
    return str(zlib.crc32("\n".join(texts).encode()))


def check(stated: str, *texts: str) -> None:
    """Checks texts that were read against their checksum.

    Raises:
        LogError: If they differ from those written.
    """
    if checksum(*texts) != stated:
        raise LogError("it is damaged: header or notes do not match their checksum")


class LogWriter(Protocol):
    """Writer of one format; notes come after the first row."""

    def rows(self, table: np.ndarray) -> None:
        """Writes some ticks, and keeps the array of shape (k, layout's width)."""

    def note(self, note: Note) -> None:
        """Keeps a note."""

    def close(self) -> None:
        """Completes the file; later rows and notes are not written."""

    def abandon(self) -> None:
        """Ends the file after an error; raises none. The readable part stays.

        Without a row, an earlier file of that name stays.
        """


def note_from_event(event: Event) -> Note:
    """Converts an event to a note."""
    data = {"kind": event.kind, "text": event.text, "data": to_plain(event.data)}
    return Note(event.time, EVENT, data)


def event_from_note(note: Note) -> Event:
    """The reverse of ``note_from_event``."""
    return Event(note.time, note.data["kind"], note.data["text"], note.data["data"])


def note_from_plan(time: float, plan: Plan, paths: PlannedPaths) -> Note:
    """Converts planned paths and footsteps to a note; a missing path has no points."""
    data = {
        field.name: []
        if (path := getattr(paths, field.name)) is None
        else (np.round(path / PATH_GRID) * PATH_GRID).round(4).tolist()
        for field in fields(PlannedPaths)
    }
    data[FOOTSTEPS] = [
        [step.index, step.foot, *map(float, step.p_WF), float(step.yaw)]
        for step in plan.footsteps
    ]
    return Note(time, PATHS, data)


def note_from_feedback(time: float, status: ControllerStatus) -> Note:
    """Converts the feedback of a user's own behavior to a note.

    Its data has the feedback, as ``to_plain`` converts it; None while a behavior of the
    interface is active, whose feedback has channels of its own.
    """
    own = None if isinstance(status.feedback, Message) else status.feedback
    return Note(time, FEEDBACK, {FEEDBACK: to_plain(own)})


def paths_from_note(note: Note) -> PlannedPaths:
    """Reads the paths from a note of ``note_from_plan``."""
    paths = {
        field.name: np.array(points)
        for field in fields(PlannedPaths)
        if (points := note.data.get(field.name))
    }
    return PlannedPaths(**paths)


def footsteps_from_note(note: Note) -> tuple[Footstep, ...]:
    """Reads the footsteps from a note of ``note_from_plan``."""
    return tuple(
        Footstep(int(index), int(foot), np.array([x, y, z]), yaw)
        for index, foot, x, y, z, yaw in note.data.get(FOOTSTEPS, ())
    )


def notes_to_json(notes: Iterable[Note]) -> str:
    """Converts notes to text, for formats that keep all notes in one place."""
    return json.dumps([[note.time, note.kind, note.data] for note in notes])


def notes_from_json(text: str) -> list[Note]:
    """The reverse of ``notes_to_json``."""
    return [Note(*entry) for entry in json.loads(text)]


DEEPEST = 16
"""Greatest nesting depth that is kept; no valid message is nested deeper."""


def to_plain(value: Any, path: tuple[int, ...] = ()) -> Any:
    """Converts messages, arrays and numbers to JSON types; NaN and infinities to None.

    Accepts any content of a refused message: unknown types become text. ``path`` holds
    the identities of the containers around ``value``, to detect a loop.
    """
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if is_whole(value):
        return int(value) if abs(value) <= LARGEST_INTEGER else shown(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    if id(value) in path or len(path) == DEEPEST:
        return "..."
    within = (*path, id(value))
    if is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: to_plain(getattr(value, field.name), within)
            for field in fields(value)
        }
    if isinstance(value, Mapping):
        return {str(key): to_plain(item, within) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return to_plain(value.tolist(), within)
    if isinstance(value, (list, tuple)):
        return [to_plain(item, within) for item in value]
    return shown(value)


LARGEST_INTEGER = 2**63 - 1
"""Largest integer that every reader of a log can represent."""
