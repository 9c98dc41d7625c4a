"""Reads logs from MCAP files, also from one that was cut off."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader

from atlas_drake.logs.header import LogError, read_header
from atlas_drake.logs.log import Log, LoggedEvent, Part
from atlas_drake.logs.mcap_writer import HEADER, METADATA, check_log_path
from atlas_drake.logs.topics import COMMANDS, EVENTS, ON_CHANGE, STRUCTURED, TIME
from atlas_drake.messages.event import MESSAGE, Event
from atlas_drake.records import Schema
from atlas_drake.records.plain import message_from
from atlas_drake.records.schema import GROUPS

TINY = 1e-6
"""Norm of a quaternion below which it gives no orientation."""


def read_log(path: str | Path) -> Log:
    """Reads a log.

    A file that was cut off is read up to the last complete message.

    Args:
        path: Path of the file, which ends in .mcap.

    Raises:
        LogError: If the file cannot be read, is not a log, is damaged, or has no
            records.
    """
    path = Path(path)
    check_log_path(path)
    try:
        if not path.exists():
            raise LogError("there is no such file")
        log = _read(path)
        _check_sound(log)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror or error}") from error
    except LogError as error:
        raise LogError(f"{path}: {error}") from error
    except Exception as error:
        # For a damaged file the library may raise any exception.
        raise LogError(f"{path}: it is not a log, or it is damaged") from error
    return log


def _read(path: Path) -> Log:
    topics: dict[int, str] = {}
    rows: dict[str, list[int]] = {}
    values: dict[str, list[Any]] = {}
    logged: list[LoggedEvent] = []
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
                    if topic == EVENTS or topic in COMMANDS:
                        logged.append(_event(topic, record))
                    elif topic in GROUPS or topic in STRUCTURED or topic == TIME:
                        rows.setdefault(topic, []).append(record.sequence)
                        values.setdefault(topic, []).append(orjson.loads(record.data))
        except Exception:
            # The end of a file that was cut off looks like damage.
            if header is None:
                raise
    if header is None:
        raise LogError("it is an MCAP file, but not of this program")
    head, schema = read_header(header)
    every_tick = [name for name in (TIME, *schema.groups) if name not in ON_CHANGE]
    count = min(len(values.get(name, ())) for name in every_tick)
    if not count:
        raise LogError("it has no records; the run ended before its first tick")
    arrays = {TIME: np.array([one[TIME] for one in values[TIME][:count]])}
    for group in schema.groups:
        arrays |= _columns(schema, group, rows[group], values[group], count)
    parts = {
        name: Part(rows.get(name, []), values.get(name, [])) for name in STRUCTURED
    }
    logged = [one for one in logged if one.row <= count]
    return Log(path, head, schema, arrays, parts, logged)


def _event(topic: str, record: Message) -> LoggedEvent:
    # Its texts may hold what only Python's own JSON takes.
    data = json.loads(record.data)
    if topic == EVENTS:
        event = Event(data["time"], data["kind"], data["message"], data["data"])
        return LoggedEvent(record.sequence, event, data["of_record"])
    message = message_from(COMMANDS[topic], data["message"])
    content = {"number": data["number"], "message": message}
    event = Event(data["time"], MESSAGE, type(message).__name__, content)
    return LoggedEvent(record.sequence, event, True)


def _columns(
    schema: Schema,
    group: str,
    rows: list[int],
    messages: list[Mapping[str, Any]],
    count: int,
) -> dict[str, np.ndarray]:
    """Returns a group's columns; a value is valid until the next one."""
    counts = np.diff(np.minimum([*rows, count], count))
    arrays = {}
    for name, column in schema.columns.items():
        if not name.startswith(f"{group}."):
            continue
        field = name.partition(".")[2]
        given = [message[field] for message in messages]
        if column.labels:
            given = [list(one.values()) for one in given]
        table = np.array(given, dtype=float).repeat(counts, axis=0)
        arrays[name] = table.astype(column.kind)
    return arrays


def _check_sound(log: Log) -> None:
    """Checks that a log can have been written by this program.

    Raises:
        ValueError: If the log is inconsistent.
    """
    if not (np.isfinite(log.time).all() and (np.diff(log.time) >= 0.0).all()):
        raise ValueError("time is not finite or decreases")
    if not 0.0 < log.header.control_period < np.inf:
        raise ValueError(f"control_period is {log.header.control_period}")
    q = log["state.q"]
    # The first four positions are the quaternion of the pelvis.
    if not (np.isfinite(q).all() and (np.linalg.norm(q[:, :4], axis=1) > TINY).all()):
        raise ValueError("state.q is not a pose")
    for behavior in np.unique(log["behavior.current"]):
        log.behavior(int(behavior))
