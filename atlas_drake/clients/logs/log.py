"""A log in memory: columns of numbers, events, and the records of the run.

``mcap_reader`` reads the file; ``figures`` draws a log, ``film.replay`` replays it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.clients.logs.header import Header, LogError
from atlas_drake.clients.logs.topics import STRUCTURED, part_of_message
from atlas_drake.errors import RobotDescriptionError, did_you_mean
from atlas_drake.messages import AtlasSimInterfaceCommand, Behavior
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.event import (
    FOOTSTEP,
    MESSAGE,
    Event,
    LoggedCommand,
    first_falls,
)
from atlas_drake.records import Schema, TickRecord
from atlas_drake.records.column import Names
from atlas_drake.records.plain import PARTS, numbers_in
from atlas_drake.records.schema import TIME
from atlas_drake.records.tick_record import landed_among
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario, scenario_from

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class Part:
    """A structured part over time: records in which it changed, and its messages."""

    rows: list[int]
    messages: list[Any]


@dataclass(frozen=True)
class LoggedEvent:
    """An event, the record that it is in, and whether a record holds it at all."""

    row: int
    event: Event
    of_record: bool


@dataclass(frozen=True)
class Log:
    """The records of a run.

    Example:
        >>> log = read_log("run.mcap")
        >>> knee = log.robot.joint_index("l_leg_kny")
        >>> log.time, log["joints.effort"][:, knee], log["joints.effort.l_leg_kny"]
        >>> [record.balance.dcm for record in log.records()]

    Attributes:
        path: File of the log.
        header: Facts about the log as a whole.
        schema: Schema of the records.
        arrays: Columns by name, shape (rows,) or (rows, elements); names, units and
            labels are in ``schema.columns``.
        parts: Structured parts of the records, by name.
        logged: Events and messages in the order of writing.
    """

    path: Path
    header: Header
    schema: Schema
    arrays: dict[str, np.ndarray]
    parts: dict[str, Part]
    logged: list[LoggedEvent]

    def __getitem__(self, name: str) -> np.ndarray:
        """A column such as ``balance.com``, or one number such as ``balance.com.x``.

        Raises:
            KeyError: If the log has no such column.
        """
        for known in (self.arrays, self.numbers):
            if name in known:
                return known[name]
        hint = did_you_mean(name, [*self.arrays, *self.numbers])
        raise KeyError(f"the log has no column {name!r}; see Log.numbers.{hint}")

    def __len__(self) -> int:
        """Number of records."""
        return len(self.time)

    @property
    def time(self) -> np.ndarray:
        """Times of the records [s], shape (rows,); never decreasing."""
        return self.arrays[TIME]

    # ---- numbers -------------------------------------------------------------

    @cached_property
    def numbers(self) -> dict[str, np.ndarray]:
        """Every number by name such as ``balance.com.x``, each of shape (rows,)."""
        tables = (
            np.atleast_2d(self.arrays[name].T)
            for name in self.schema.columns
            if name != TIME
        )
        numbers = chain.from_iterable(tables)
        return dict(zip(self.schema.units, numbers, strict=True)) | self.part_columns

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of ``numbers``; empty where none is declared."""
        return self.schema.units | dict.fromkeys(self.part_columns, "")

    @cached_property
    def part_columns(self) -> dict[str, np.ndarray]:
        """Numbers in the structured parts, by path such as ``walk.t_step_rem``."""
        columns: dict[str, np.ndarray] = {}
        for name in PARTS:
            part = self.parts[name]
            for row, plain in zip(part.rows, part.messages, strict=True):
                for path, number in numbers_in(part_of_message(name, plain), name):
                    if path not in columns:
                        columns[path] = np.full(len(self), np.nan)
                    columns[path][row:] = number
        return columns

    def to_pandas(self) -> DataFrame:
        """Returns ``numbers`` as a table whose index is the time [s].

        Raises:
            ImportError: If pandas is not installed.
        """
        import pandas

        return pandas.DataFrame(self.numbers, pandas.Index(self.time, name=TIME))

    def to_npz(self, path: str | Path) -> None:
        """Writes the columns, and the labels of their elements, for ``numpy.load``.

        The labels of ``balance.com`` have the name ``balance.com.labels``.

        Args:
            path: Path of the file.
        """
        labels: Any = {
            f"{name}.labels": np.array(column.elements)
            for name, column in self.schema.columns.items()
            if column.elements
        }
        with Path(path).open("wb") as file:
            np.savez_compressed(file, **(self.arrays | labels | self.part_columns))

    # ---- records -------------------------------------------------------------

    def records(self) -> Iterator[TickRecord]:
        """The records of the run, in order, as ``sim.record`` had them."""
        for row in range(len(self)):
            yield self.record(row)

    def record(self, row: int) -> TickRecord:
        """The record of a row.

        Args:
            row: Number of the record, from 0.
        """
        numbers = {name: array[row] for name, array in self.arrays.items()}
        groups: dict[str, Any] = {
            group: self.schema.group_at(group, numbers) for group in self.schema.groups
        }
        parts = {name: self._part(name, row) for name in self.parts}
        events = tuple(one.event for one in self._by_row.get(row, ()) if one.of_record)
        begin = max((reset for reset in self._resets if reset <= row), default=0)
        return TickRecord(
            time=float(self.time[row]),
            request=self._requests.get(int(numbers["behavior.request_number"])),
            events=events,
            landed=landed_among(
                event for at, event in self._landings if begin <= at <= row
            ),
            **groups,
            **parts,
        )

    def paths_at(self, row: int) -> PlannedPaths | None:
        """The planned paths that were logged last, if any.

        Args:
            row: Number of the record until which they count.
        """
        for place in range(bisect_right(self.parts["paths"].rows, row) - 1, -1, -1):
            paths: PlannedPaths | None = self._read_part("paths", place)
            if paths is not None:
                return paths
        return None

    def row_at(self, time: float) -> int:
        """Number of the latest record that is not after a time, or of the first.

        Args:
            time: Simulated time [s].
        """
        # A small tolerance, because times are sums of rounded periods.
        return max(int(np.searchsorted(self.time, time + 1e-9, side="right")) - 1, 0)

    def _part(self, name: str, row: int) -> Any:
        place = bisect_right(self.parts[name].rows, row) - 1
        return STRUCTURED[name].blank if place < 0 else self._read_part(name, place)

    def _read_part(self, name: str, place: int) -> Any:
        """Makes a structured value once for all records that have it."""
        key = name, place
        if key not in self._made:
            try:
                plain = part_of_message(name, self.parts[name].messages[place])
                self._made[key] = STRUCTURED[name].read(plain)
            except Exception as error:  # Readers raise whatever does not fit.
                problem = f"a message on /{name} is damaged: {error!r}"
                raise LogError(f"{self.path}: {problem}") from error
        return self._made[key]

    @cached_property
    def _made(self) -> dict[tuple[str, int], Any]:
        return {}

    @cached_property
    def _by_row(self) -> dict[int, list[LoggedEvent]]:
        found: dict[int, list[LoggedEvent]] = {}
        for one in self.logged:
            found.setdefault(one.row, []).append(one)
        return found

    @cached_property
    def _landings(self) -> list[tuple[int, Event]]:
        return [
            (one.row, one.event)
            for one in self.logged
            if one.of_record and one.event.kind == FOOTSTEP
        ]

    @cached_property
    def _resets(self) -> list[int]:
        """The first records after resets."""
        return [one.row for one in self.logged if one.event.kind == "reset"]

    @cached_property
    def _requests(self) -> dict[int, AtlasSimInterfaceCommand]:
        return {
            one.event.data["number"]: one.event.data["message"]
            for one in self.logged
            if one.event.kind == MESSAGE
            and isinstance(one.event.data["message"], AtlasSimInterfaceCommand)
        }

    # ---- events --------------------------------------------------------------

    @cached_property
    def events(self) -> list[Event]:
        """Events in order of time, as ``sim.events`` had them."""
        events = [one.event for one in self.logged if one.event.kind != MESSAGE]
        return first_falls(sorted(events, key=lambda event: event.time))

    @cached_property
    def commands(self) -> list[LoggedCommand]:
        """The commands as they were received, in order."""
        return [
            LoggedCommand.of(one.event)
            for one in self.logged
            if one.event.kind == MESSAGE
        ]

    def behavior(self, number: int) -> Behavior:
        """Returns the behavior of a number in the column ``behavior.current``.

        Args:
            number: Number in that column.
        """
        return self.header.catalog.find(number)

    # ---- what was simulated --------------------------------------------------

    @cached_property
    def robot(self) -> Robot:
        """The robot that was simulated.

        Raises:
            LogError: If the robot is unknown, its files are missing, or its joints have
                changed since the run.
        """
        model = self.header.model
        try:
            robot = load_robot(model)
        except RobotDescriptionError as error:
            raise LogError(
                f"{self.path}: its robot cannot be loaded: {error}"
            ) from error
        if self.schema.names[Names.JOINTS] != robot.joint_names:
            raise LogError(
                f"{self.path}: its robot, {model}, has other joints than "
                "when the log was recorded; restore its file of that time"
            )
        return robot

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario that was simulated.

        Raises:
            LogError: If this version of the program cannot run the scenario.
        """
        fields = self.header.scenario
        try:
            return scenario_from(fields)
        except Exception as error:
            # The loader raises many kinds of exception.
            raise LogError(f"{self.path}: its scenario is unknown: {error}") from error
