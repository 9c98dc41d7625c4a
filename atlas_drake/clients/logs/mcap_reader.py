"""Reads logs from MCAP files, also from one that was cut off."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.clients.logs.header import LogError, read_header
from atlas_drake.clients.logs.log import Log, LoggedEvent, Part
from atlas_drake.clients.logs.mcap_writer import HEADER, METADATA, check_log_path
from atlas_drake.clients.logs.topics import EVENTS, STRUCTURED, event_of_message
from atlas_drake.messages.atlas_command import COMMANDS
from atlas_drake.records import Schema
from atlas_drake.records.schema import TIME


def read_log(path: str | Path) -> Log:
    """Reads a log.

    A file that was cut off is read up to the last complete record.

    Args:
        path: Path of the file, which ends in .mcap.

    Raises:
        LogError: If the file cannot be read, is not a log, is damaged, or has no
            records.
    """
    path = Path(path)
    check_log_path(path)
    if problem := why_not_readable(path):
        raise LogError(f"{path}: {problem}")
    try:
        return _read(path)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror or error}") from error
    except LogError as error:
        raise LogError(f"{path}: {error}") from error
    except Exception as error:
        raise LogError(f"{path}: it is no log that can be read: {error!r}") from error


def _read(path: Path) -> Log:
    topics: dict[int, str] = {}
    messages: dict[str, list[Message]] = defaultdict(list)
    received: list[tuple[str, Message]] = []
    header = None
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, validate_crcs=True).records:
                if isinstance(record, Metadata) and record.name == METADATA:
                    header = record.metadata[HEADER]
                elif isinstance(record, Channel):
                    topics[record.id] = record.topic.removeprefix("/")
                elif isinstance(record, Message):
                    topic = topics[record.channel_id]
                    messages[topic].append(record)
                    if topic == EVENTS or topic in COMMANDS:
                        received.append((topic, record))
        except Exception:
            # The library may raise any exception at the end of a file that was cut off;
            # what came before has passed its checks.
            if header is None:
                raise
    if header is None:
        raise LogError("it is an MCAP file, but not of this program")
    head, schema = read_header(header, path)
    # The time is the last message of a record.
    count = len(messages[TIME])
    if not count:
        raise LogError("it has no records; the run ended before its first tick")
    plain = {
        name: [orjson.loads(message.data) for message in messages[name]]
        for name in (TIME, *schema.groups, *STRUCTURED)
    }
    rows = {name: [one.sequence for one in messages[name]] for name in plain}
    arrays = {TIME: np.array([one[TIME] for one in plain[TIME]], dtype=float)}
    if not np.isfinite(arrays[TIME]).all():
        raise LogError(f"/{TIME}: a record has no time")
    for group in schema.groups:
        arrays |= _columns(schema, group, rows[group], plain[group], count)
    parts = {name: Part(rows[name], plain[name]) for name in STRUCTURED}
    logged = [
        LoggedEvent(
            message.sequence, *event_of_message(topic, json.loads(message.data))
        )
        for topic, message in received
        if message.sequence <= count
    ]
    return Log(path, head, schema, arrays, parts, logged)


def _columns(
    schema: Schema,
    group: str,
    rows: Sequence[int],
    messages: Sequence[Mapping[str, Any]],
    count: int,
) -> dict[str, np.ndarray]:
    """Returns a group's columns; a value is valid until the next one."""
    counts = np.diff(np.minimum([*rows, count], count))
    arrays = {}
    for field, column in schema.parts[group].items():
        given = [message[field] for message in messages]
        if column.labels:
            given = [list(one.values()) for one in given]
        table = np.array(given, dtype=float)
        one = (len(column.elements),) if column.labels else ()
        if given and table.shape[1:] != one:
            raise LogError(f"/{group}: {field} has not the elements of its schema")
        table = table.repeat(counts, axis=0)
        arrays[f"{group}.{field}"] = table.astype(column.kind)
    return arrays
