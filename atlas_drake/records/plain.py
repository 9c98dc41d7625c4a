"""Values of a run as plain data, as JSON has it, and as numbers with names."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from atlas_drake.config import is_number, is_whole
from atlas_drake.errors import InvalidMessageError, did_you_mean, shown
from atlas_drake.messages import Message
from atlas_drake.records.schema import Schema
from atlas_drake.records.tick_record import TickRecord

PARTS = ("stand", "walk", "step", "manipulate", "feedback", "plan", "footsteps")
"""Structured parts of a record whose numbers have names."""


def to_plain(value: Any) -> Any:
    """Converts messages, arrays and numbers to JSON types; NaN and infinities to None.

    Values of unknown types become text.
    """
    if value is None:
        return value
    if isinstance(value, str):
        # A half of a character is no text for other programs.
        return value if value.isascii() else value.encode(errors="replace").decode()
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if is_whole(value):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: to_plain(getattr(value, field.name)) for field in fields(value)
        }
    if isinstance(value, Mapping):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return to_plain(value.tolist())
    if isinstance(value, list | tuple):
        return [to_plain(item) for item in value]
    return shown(value)


def message_from(
    kind: type[Message],
    plain: Mapping[str, Any],
    *,
    num_joints: int | None = None,
    path: str = "",
) -> Message:
    """Make a message from its fields; omitted fields stay as in an empty message."""
    message = kind()
    known = [field.name for field in fields(message)]  # type: ignore[arg-type]
    for name, value in plain.items():
        place = f"{path}.{name}".lstrip(".")
        if name not in known:
            hint = did_you_mean(str(name), known) or f" There are {', '.join(known)}."
            problem = f"{kind.__name__} has no such field.{hint}"
            raise InvalidMessageError(place, value, problem)
        default = getattr(message, name)
        setattr(message, name, _like(default, value, num_joints, place))
    return message


def _like(default: Any, plain: Any, num_joints: int | None, path: str) -> Any:
    """Converts the plain value of a field to the type of its default."""
    if isinstance(default, Message):
        if not isinstance(plain, Mapping):
            wanted = f"must be fields of {type(default).__name__}"
            raise InvalidMessageError(path, plain, f"is {shown(plain)}; {wanted}")
        return message_from(type(default), plain, num_joints=num_joints, path=path)
    if not isinstance(default, list):
        return plain
    if default and isinstance(default[0], Message) and isinstance(plain, list | tuple):
        given = [
            _like(default[0], item, num_joints, f"{path}[{index}]")
            for index, item in enumerate(plain)
        ]
        return given + default[len(given) :]
    if not default and num_joints is not None and is_number(plain):
        return [plain] * num_joints
    return plain


# ---- numbers by name, such as ``balance.com.x`` ------------------------------


def flat_units(schema: Schema, record: TickRecord) -> dict[str, str]:
    """Returns the unit of each number of a record by name; empty for parts."""
    parts = {name: "" for part in PARTS for name, _ in _part(record, part)}
    return schema.units | parts


def flat_numbers(
    schema: Schema, record: TickRecord, names: Collection[str]
) -> dict[str, float]:
    """Returns some numbers of a record by name; NaN for what it does not have."""
    found: dict[str, float] = {}
    for topic in {name.partition(".")[0] for name in names}:
        if topic in PARTS:
            found |= _part(record, topic)
        elif topic in schema.groups:
            plain = schema.plain(topic, getattr(record, topic))
            found |= numbers_in(plain, topic)
    return {name: found.get(name, float("nan")) for name in names}


def _part(record: TickRecord, name: str) -> Iterator[tuple[str, float]]:
    return numbers_in(to_plain(getattr(record, name)), name)


def numbers_in(value: Any, path: str) -> Iterator[tuple[str, float]]:
    """Yields paths and numbers in a plain value; truth values count as 0 and 1."""
    if isinstance(value, (bool, int, float)):
        yield path, float(value)
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from numbers_in(item, f"{path}.{name}")
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from numbers_in(item, f"{path}.{place}")
