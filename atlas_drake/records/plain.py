"""Values of a run as plain data, as JSON has it, and as numbers with names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from atlas_drake.config import is_number, is_whole
from atlas_drake.errors import InvalidMessageError, did_you_mean, shown
from atlas_drake.messages import Message

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


def leaves(value: Any, keys: tuple[str | int, ...]) -> Iterator[tuple[Any, float]]:
    """Yields the keys of each number in a plain value, after those of the value itself.

    Truth values count as 0 and 1.
    """
    if isinstance(value, (bool, int, float)):
        yield keys, float(value)
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from leaves(item, (*keys, name))
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from leaves(item, (*keys, place))


def numbers_in(value: Any, path: str) -> Iterator[tuple[str, float]]:
    """Yields paths and numbers in a plain value."""
    for keys, number in leaves(value, (path,)):
        yield ".".join(map(str, keys)), number
