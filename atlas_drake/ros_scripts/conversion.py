"""Conversion between ROS messages and the messages of this package, field by field.

Values are checked by ``messages.door``, not here. Three things differ between the
two: a stamp is seconds in this package, bytes are numbers, and a part that is still all
zero, as ROS makes it, becomes the default of this package, because an all-zero
quaternion or step has no meaning.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import fields
from enum import IntEnum, IntFlag
from typing import Any, TypeVar

import numpy as np

from atlas_drake.messages import Message
from atlas_drake.ros_scripts.message_types import BYTES, NOT_IN_ROS, ROS_TYPES
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Time

M = TypeVar("M", bound=Message)


def to_ours(message: Any, kind: type[M]) -> M:
    """Convert a ROS message to a message of type ``kind``."""
    result = kind()
    for field in fields(kind):  # type: ignore[arg-type]
        if field.name not in NOT_IN_ROS:
            value = getattr(message, field.name)
            default = getattr(result, field.name)
            setattr(result, field.name, _value_to_ours(value, default))
    return result


def _value_to_ours(value: Any, default: Any) -> Any:
    """Convert one value; ``default`` is the field's default in this package."""
    if isinstance(default, Message):
        is_unset = isinstance(value, RosMessage) and value == type(value)()
        return default if is_unset else to_ours(value, type(default))
    if isinstance(default, list) and default and isinstance(value, Sequence):
        return [_value_to_ours(part, type(default[0])()) for part in value]
    if isinstance(value, Time):
        return value.to_sec()
    if isinstance(value, bytes | bytearray):
        return list(value)
    if isinstance(default, list) and isinstance(value, str):
        # Bytes of Python 2: "".join(chr(255) for ...).
        return [ord(character) for character in value]
    return value


def from_ours(message: Message) -> Any:
    """Convert a message of this package to ROS."""
    ros, shared, rest = _plan(type(message))  # type: ignore[arg-type]
    # Skip the initial values, nearly all of which would be replaced.
    result = object.__new__(ros)
    put = object.__setattr__
    for name in shared:
        put(result, name, _value_to_ros(name, getattr(message, name)))
    for name in rest:
        put(result, name, ros._factories[name]())
    return result


@functools.cache
def _plan(kind: type[Message]) -> tuple[type[RosMessage], list[str], list[str]]:
    """Return the ROS class, its fields that both have, and its other fields."""
    ros = ROS_TYPES[kind]
    own = {field.name for field in fields(kind)}  # type: ignore[arg-type]
    shared = [name for name in ros._factories if name in own]
    return ros, shared, [name for name in ros._factories if name not in own]


_PLAIN = (float, int, bool, str)


def _value_to_ros(name: str, value: Any) -> Any:
    if name == "stamp":
        return Time.from_sec(value or 0.0)
    if type(value) in _PLAIN:
        return value
    if isinstance(value, Message):
        return from_ours(value)
    if name in BYTES:
        return bytes(int(number) for number in value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Sequence):
        plain = not value or type(value[0]) in _PLAIN
        return list(value) if plain else [_value_to_ros("", item) for item in value]
    return int(value) if isinstance(value, IntEnum | IntFlag) else value
