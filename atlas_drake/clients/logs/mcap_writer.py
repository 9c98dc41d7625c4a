"""Writes records to MCAP, which Foxglove and PlotJuggler open: JSON on topics.

The file grows during the run; it can be read even if the run ends abruptly.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path
from typing import IO, Any

import orjson
from mcap.writer import CompressionType, Writer
from pydrake.common.yaml import yaml_dump

from atlas_drake.atomic_write import why_not_writable
from atlas_drake.clients.logs.header import Header, LogError, OwnBehavior
from atlas_drake.clients.logs.topics import (
    ON_CHANGE,
    STRUCTURED,
    VIEWER_PERIOD,
    json_schemas,
    message_of_event,
    message_of_part,
    nanoseconds,
    viewer_messages,
)
from atlas_drake.config import as_plain
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.messages.event import Event
from atlas_drake.records import Schema, TickRecord
from atlas_drake.records.plain import to_plain
from atlas_drake.records.schema import TIME
from atlas_drake.robot import Robot
from atlas_drake.scenario.scenario import Scenario

METADATA, HEADER = "atlas_drake", "header"
"""Names of the metadata record that holds the header, and of its entry."""
SUFFIX = ".mcap"


def check_log_path(path: Path) -> None:
    """Raises LogError if a log's name does not end in ``.mcap``."""
    if path.suffix != SUFFIX:
        raise LogError(f"{path}: a log must end in {SUFFIX}")


def header_of(
    scenario: Scenario, robot: Robot, behaviors: Sequence[BehaviorInterface]
) -> Header:
    """Makes the header of a log; ``behaviors`` are the user's own."""
    kept = [field.name for field in fields(OwnBehavior)]
    return Header(
        {
            "model": robot.model,
            "control_period": scenario.control_period,
            "scenario": yaml_dump(as_plain(scenario)),
            "behaviors": [
                {name: getattr(behavior, name) for name in kept}
                for behavior in behaviors
            ],
        }
    )


class McapWriter:
    """Writes each record as one message per topic; some topics only on change.

    Without a record no log is written, and an earlier file of that name stays.

    Attributes:
        path: Path of the file.
        fault: Error that ended the writing; None if there was none.
    """

    def __init__(self, path: Path) -> None:
        """Checks that the file can be written; raises LogError if it cannot."""
        check_log_path(path)
        problem = why_not_writable(path)
        if problem is not None:
            raise LogError(problem)
        self.path = path
        self.fault: LogError | None = None
        self._file: IO[bytes] | None = None
        self._early: list[Event] = []
        self._closed = False

    def begin(self, header: Header, schema: Schema) -> None:
        """Takes the header, and the schema of the records that will come."""
        self._header, self._schema = header, schema

    def record(self, record: TickRecord) -> None:
        """Writes a record, unless the file is closed or could not be written."""
        if self._closed:
            return
        with self._latched_fault():
            if self._file is None:
                self._open()
            self._write(record)

    def event(self, event: Event) -> None:
        """Writes an event that no record holds."""
        if self._closed:
            return
        if self._file is None:
            self._early.append(event)
            return
        with self._latched_fault():
            self._add_event(event, of_record=False)

    def close(self) -> None:
        """Completes the file with its index.

        Raises:
            LogError: If it cannot be written, now or earlier.
        """
        if self._file is not None and not self._closed:
            with self._latched_fault():
                self._writer.finish()
                self._file.close()
        self._closed = True
        if self.fault is not None:
            raise self.fault

    @contextmanager
    def _latched_fault(self) -> Iterator[None]:
        """Lets a run continue when its log cannot be written."""
        try:
            yield
        except OSError as error:
            problem = error.strerror or error
            self.fault = LogError(f"{self.path}: cannot be written: {problem}")
            self._closed = True
            if self._file is not None:
                with suppress(OSError):  # It tries to write the rest again.
                    self._file.close()

    def _open(self) -> None:
        """Empties the file and describes all topics."""
        self._file = self.path.open("wb")
        self._writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(library="atlas_drake")
        text = self._header.to_json(self._schema)
        self._writer.add_metadata(METADATA, {HEADER: text})
        self._channels: dict[str, int] = {}
        for topic, name, schema in json_schemas(self._schema):
            key = self._writer.register_schema(name, "jsonschema", orjson.dumps(schema))
            channel = self._writer.register_channel(f"/{topic}", "json", key)
            self._channels[topic] = channel
        self._latest: dict[str, bytes] = {
            name: _dumped(name, part.blank) for name, part in STRUCTURED.items()
        }
        self._rows = 0
        self._viewer_time = -1.0
        while self._early:
            self._add_event(self._early.pop(0), of_record=False)

    def _write(self, record: TickRecord) -> None:
        schema, time = self._schema, record.time
        plain = {
            name: schema.plain(name, getattr(record, name)) for name in schema.groups
        }
        for name, numbers in plain.items():
            data = orjson.dumps(numbers)
            if name not in ON_CHANGE or self._is_new(name, data):
                self._add(time, name, data)
        for name in STRUCTURED:
            data = _dumped(name, getattr(record, name))
            if self._is_new(name, data):
                self._add(time, name, data)
        for event in record.events:
            self._add_event(event, of_record=True)
        # Last: where a file is cut off, a record without it is not whole.
        self._add(time, TIME, orjson.dumps({TIME: time}))
        if not 0.0 <= time - self._viewer_time < VIEWER_PERIOD - 1e-9:
            self._viewer_time = time
            for name, message in viewer_messages(time, plain):
                self._add(time, name, orjson.dumps(message))
        self._rows += 1

    def _is_new(self, topic: str, data: bytes) -> bool:
        """Returns True if a message differs from the latest one of its topic."""
        before = self._latest.get(topic)
        self._latest[topic] = data
        return data != before

    def _add_event(self, event: Event, *, of_record: bool) -> None:
        topic, message = message_of_event(event, of_record)
        # Data of a user's event may hold what only Python's own JSON takes.
        self._add(event.time, topic, json.dumps(message).encode())

    def _add(self, time: float, topic: str, data: bytes) -> None:
        """Adds a message; its sequence is the number of the record."""
        stamp = nanoseconds(time)
        self._writer.add_message(
            self._channels[topic],
            log_time=stamp,
            data=data,
            publish_time=stamp,
            sequence=self._rows,
        )


def _dumped(name: str, value: Any) -> bytes:
    """Converts a structured part to JSON, with null for NaN and infinities."""
    return orjson.dumps(
        message_of_part(name, value),
        default=to_plain,
        option=orjson.OPT_SERIALIZE_NUMPY,
    )
