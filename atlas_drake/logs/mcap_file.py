"""Logs as MCAP, which Foxglove and PlotJuggler open: JSON messages on topics.

Needs ``mcap`` and ``orjson``. The file grows during the run; it can be read even if the
run ends abruptly.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import numpy as np
import orjson
from mcap.records import Channel as McapChannel
from mcap.records import Message, Metadata
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from atlas_drake.logs.layout import Channel, Layout
from atlas_drake.logs.notes import (
    COMMANDS,
    EVENT,
    FEEDBACK,
    FOOTSTEPS,
    PATHS,
    Header,
    LogError,
    Note,
    check,
    checksum,
    to_plain,
)
from atlas_drake.logs.viewer_messages import (
    VIEWER_SCHEMAS,
    event_message,
    json_schema,
    viewer_messages,
)

METADATA, HEADER, CHECKSUM = "atlas_drake", "header", "crc32"
"""Names of the metadata record that holds the header, and of its entries; MCAP's own
checksums cover the messages only."""
VIEWER_PERIOD = 0.02
"""Time between messages that are only for viewers [s]."""
SELDOM = frozenset(
    {"gains", "behavior", "stand", "walk", "step", "manipulate", "hands"}
)
"""Topics that are written only when they change."""
CHUNK = 1 << 20
"""Size of a chunk of messages, which is compressed, or lost, as a whole [byte]."""


class McapWriter:
    """Writes each tick as one message per topic, but SELDOM ones only on change."""

    def __init__(self, path: Path, header: Header):
        """Locks the file; its content stays until the first row."""
        self._header = header
        self._layout = header.layout
        self._path = path
        self._is_new = not path.exists()
        # The file is emptied only after it is locked for this run.
        self._lock = path.open("ab")
        _lock(self._lock)
        self._file: Any = None
        self._lengths = deque([0], maxlen=2)
        self._channels: dict[str, int] = {}
        self._rows = 0
        self._latest: dict[str, bytes] = {}
        self._viewer_time = -np.inf
        self._topics = _topics(self._layout)

    def _begin(self) -> None:
        """Empties the file and describes all topics."""
        self._file = self._path.open("wb")
        self._writer = Writer(
            self._file, chunk_size=CHUNK, compression=CompressionType.ZSTD
        )
        self._writer.start(library="atlas_drake")
        header = self._header.to_json()
        entries = {HEADER: header, CHECKSUM: checksum(header)}
        self._writer.add_metadata(METADATA, entries)
        blank = [0.0] * self._layout.width
        for name, topic in self._topics.items():
            self._register(name, f"atlas_drake.{name}", topic.message(blank))
        for kind, message in COMMANDS.items():
            self._register(kind, f"atlas_drake.{message.__name__}", to_plain(message()))
        points = {name: [[0.0]] for name in ("com", "dcm", "cop", "swing", FOOTSTEPS)}
        self._register(PATHS, "atlas_drake.PlannedPaths", points)
        self._register(FEEDBACK, "atlas_drake.Feedback", {FEEDBACK: {}})
        for name, (schema, sample) in VIEWER_SCHEMAS.items():
            self._register(name, schema, sample)
        self._file.flush()
        # Lengths of the file with all chunks but one, and with all of them.
        self._lengths = deque([self._file.tell()], maxlen=2)

    def rows(self, table: np.ndarray) -> None:
        """Writes some ticks."""
        if self._file is None:
            self._begin()
        for row in table:
            self._write_row(row)

    def _write_row(self, row: np.ndarray) -> None:
        values = row.tolist()
        time = values[0]
        for name, topic in self._topics.items():
            if name in SELDOM:
                numbers = row[topic.places].tobytes()
                if numbers == self._latest.get(name):
                    continue
                self._latest[name] = numbers
            self._add(time, name, orjson.dumps(topic.message(values)))
        self._rows += 1
        if time >= self._viewer_time + VIEWER_PERIOD - 1e-9:
            self._viewer_time = time
            for name, message in viewer_messages(self._layout, values):
                self._add(time, name, orjson.dumps(message))
        if (length := self._file.tell()) != self._lengths[-1]:
            # A chunk counts once it is in the file, for any size of the buffer.
            self._file.flush()
            self._lengths.append(length)

    def note(self, note: Note) -> None:
        """Writes a note."""
        if note.kind == EVENT:
            topic, message = "events", event_message(note)
        else:
            topic, message = note.kind, note.data
        # A refused message may hold whole numbers that only Python's own JSON takes.
        self._add(note.time, topic, json.dumps(message).encode())

    def close(self) -> None:
        """Completes the file with its index."""
        self._writer.finish()
        self._file.close()
        self._lock.close()

    def abandon(self) -> None:
        """Truncates the file after the last complete chunk.

        On a full disk the last complete chunk is removed as well, to leave space for
        the files that are still to be written. Without a row the file is unchanged.
        """
        if self._file is None:
            if self._is_new:
                self._path.unlink(missing_ok=True)
            self._lock.close()
            return
        for file in (self._file, self._lock):
            with suppress(OSError):
                file.close()
        with suppress(OSError):
            os.truncate(self._path, self._lengths[0])

    def _register(self, topic: str, name: str, sample: Any) -> None:
        schema = self._writer.register_schema(
            name, "jsonschema", json.dumps(json_schema(sample)).encode()
        )
        self._channels[topic] = self._writer.register_channel(
            f"/{topic}", "json", schema
        )

    def _add(self, time: float, topic: str, data: bytes) -> None:
        """Adds a message in JSON; orjson writes null for NaN and infinities."""
        stamp = round(1e9 * time)
        self._writer.add_message(
            self._channels[topic],
            log_time=stamp,
            data=data,
            publish_time=stamp,
            sequence=self._rows,
        )


def _lock(file: IO[bytes]) -> None:
    """Locks a file while it is open.

    Raises:
        OSError: If another run has locked it.
    """
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        file.close()
        raise OSError("another run is writing it") from error
    except OSError:
        pass  # Some network drives do not support locks.


def read_mcap(path: Path) -> tuple[Header, dict[str, np.ndarray], list[Note]]:
    """Reads header, channels and notes of a file, which may be incomplete.

    Raises:
        LogError: If it is not a log of this program.
        Exception: Anything else if it is damaged.
    """
    topics: dict[int, str] = {}
    messages: dict[str, list[Message]] = {}
    notes: list[Note] = []
    header = None
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, validate_crcs=True).records:
                if isinstance(record, Metadata) and record.name == METADATA:
                    if CHECKSUM in record.metadata:  # Older logs have none.
                        check(record.metadata[CHECKSUM], record.metadata[HEADER])
                    header = Header.from_json(record.metadata[HEADER])
                elif isinstance(record, McapChannel):
                    topics[record.id] = record.topic.removeprefix("/")
                elif isinstance(record, Message):
                    topic = topics[record.channel_id]
                    if topic in (*COMMANDS, PATHS, FEEDBACK, "events"):
                        notes.append(_note(topic, record))
                    elif topic not in VIEWER_SCHEMAS:
                        messages.setdefault(topic, []).append(record)
        except Exception:
            # The end of an incomplete file looks like damage.
            if header is None:
                raise
    if header is None:
        raise LogError("it is an MCAP file, but not of this program")
    return header, _arrays(header.layout, messages), notes


def _note(topic: str, record: Message) -> Note:
    data = json.loads(record.data)
    if topic == "events":
        plain = {"kind": data["kind"], "text": data["message"], "data": data["data"]}
        return Note(data["time"], EVENT, plain)
    return Note(record.log_time / 1e9, topic, data)


def _arrays(
    layout: Layout, messages: dict[str, list[Message]]
) -> dict[str, np.ndarray]:
    """Rows that exist in all topics; a message's sequence is the number of its row."""
    topics = _topics(layout)
    count = min(len(messages.get(t, ())) for t in topics if t not in SELDOM)
    table = np.empty((count, layout.width))
    for name, topic in topics.items():
        found = messages.get(name, ())
        # A value that is written on change is valid until the next one.
        ends = [*(message.sequence for message in found[1:]), count]
        for message, end in zip(found, ends, strict=False):
            if message.sequence >= count:
                break
            last = end if name in SELDOM else message.sequence + 1
            topic.fill(table[message.sequence : last], json.loads(message.data))
    return layout.split(table)


class _Topic:
    """The part of a row in one topic: indices and names.

    Attributes:
        places: Indices of the part.
    """

    def __init__(self, channels: Sequence[Channel], layout: Layout):
        self.places = np.r_[tuple(layout.places[channel.name] for channel in channels)]
        self._fields = [
            (channel.name.split(".")[-1], channel.labels, layout.places[channel.name])
            for channel in channels
        ]

    def message(self, row: list[Any]) -> dict[str, Any]:
        """Makes the topic's message from a row."""
        return {
            name: dict(zip(labels, row[place], strict=True))
            if labels
            else row[place.start]
            for name, labels, place in self._fields
        }

    def fill(self, rows: np.ndarray, message: dict[str, Any]) -> None:
        """Copies a message into rows, with NaN for None."""
        for name, labels, place in self._fields:
            value = message[name]
            rows[:, place] = np.array(
                list(value.values()) if labels else value, dtype=float
            )


def _topics(layout: Layout) -> dict[str, _Topic]:
    """All topics; the name of each is the first word of its channels' names."""
    channels: dict[str, list[Channel]] = {}
    for channel in layout.channels:
        channels.setdefault(channel.name.split(".")[0], []).append(channel)
    return {name: _Topic(part, layout) for name, part in channels.items()}
