"""The numbers of a record one by one, by name such as ``balance.com.x``."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

from atlas_drake.records.plain import to_plain
from atlas_drake.records.schema import Schema
from atlas_drake.records.tick_record import TickRecord

PARTS = ("stand", "walk", "step", "manipulate", "feedback", "plan", "footsteps")
"""Structured parts of a record whose numbers have names."""


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
