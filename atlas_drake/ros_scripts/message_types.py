"""The messages that a program can import, and their conversion to ours, by field.

The fields of ``atlas_msgs`` are derived from the messages of this package, so that each
field is listed once. Only the general messages of ROS are written out here.

Values are checked by ``messages.door``, not here. Three things differ between the
two: a stamp is seconds in this package, bytes are numbers, and a part that is still all
zero, as ROS makes it, becomes the default of this package, because an all-zero
quaternion or step has no meaning.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from atlas_drake import messages as ours
from atlas_drake.messages import Message
from atlas_drake.robot import Robot
from atlas_drake.ros_scripts.ros_message import (
    Factory,
    RosMessage,
    Time,
    array_of,
    message_type,
)

M = TypeVar("M", bound=Message)

NOT_IN_ROS = {"params", "feedback"}
"""Fields of this package's messages that the original does not have."""
BYTES = {"k_effort"}
"""Fields that are ``uint8[]``, which ROS hands out as bytes."""

_Types = dict[str, type[RosMessage]]


def _package(name: str, **types: dict[str, Factory]) -> _Types:
    """Make the messages of a package, from the makers of their fields."""
    return {
        short: message_type(f"{name}/{short}", fields)
        for short, fields in types.items()
    }


_XYZ: dict[str, Factory] = dict.fromkeys("xyz", float)
_NINE = array_of(float, 9)

std_msgs = _package(
    "std_msgs",
    Header={"seq": int, "stamp": Time, "frame_id": str},
    String={"data": str},
)
Header = std_msgs["Header"]
geometry_msgs = _package(
    "geometry_msgs", Point=_XYZ, Vector3=_XYZ, Quaternion=dict.fromkeys("xyzw", float)
)
_Point, _Vector3, _Quaternion = geometry_msgs.values()
geometry_msgs |= _package(
    "geometry_msgs",
    Pose={"position": _Point, "orientation": _Quaternion},
    Twist={"linear": _Vector3, "angular": _Vector3},
    Wrench={"force": _Vector3, "torque": _Vector3},
)
sensor_msgs = _package(
    "sensor_msgs",
    Imu={
        "header": Header,
        "orientation": _Quaternion,
        "orientation_covariance": _NINE,
        "angular_velocity": _Vector3,
        "angular_velocity_covariance": _NINE,
        "linear_acceleration": _Vector3,
        "linear_acceleration_covariance": _NINE,
    },
    JointState={
        "header": Header,
        **dict.fromkeys(("name", "position", "velocity", "effort"), list),
    },
)
rosgraph_msgs = _package("rosgraph_msgs", Clock={"clock": Time})

ROS_TYPES: dict[type[Message], type[RosMessage]] = {
    ours.Header: Header,
    ours.Imu: sensor_msgs["Imu"],
    **{
        kind: geometry_msgs[kind.__name__]
        for kind in (ours.Vector3, ours.Quaternion, ours.Pose, ours.Twist, ours.Wrench)
    },
}
"""The ROS message for each message of this package; those of atlas_msgs join below."""


def _constants(kind: type) -> dict[str, int]:
    """Return the whole-number constants of a class and its bases."""
    names = [name for name in dir(kind) if not name.startswith("_")]
    return {
        name: int(getattr(kind, name))
        for name in names
        if isinstance(getattr(kind, name), int)
    }


def _factory(name: str, value: Any) -> Factory:
    """Return the maker of a field's initial value, from the value in this package."""
    if name == "position" and isinstance(value, ours.Vector3):
        return geometry_msgs["Point"]
    if isinstance(value, Message):
        return _ros_type(type(value))
    if isinstance(value, list) and value:
        return array_of(_ros_type(type(value[0])), len(value))
    if isinstance(value, list):
        return bytes if name in BYTES else list
    # Values of enumerations are numbers in ROS.
    return next(kind for kind in (bool, int, float, str) if isinstance(value, kind))


def _ros_type(kind: type[Message]) -> type[RosMessage]:
    """Return the ROS message for a message of this package."""
    if kind not in ROS_TYPES:
        empty = kind()
        content = {
            field.name: _factory(field.name, getattr(empty, field.name))
            for field in fields(kind)  # type: ignore[arg-type]
            if field.name not in NOT_IN_ROS
        }
        name = f"atlas_msgs/{kind.__name__}"
        ROS_TYPES[kind] = message_type(name, content, _constants(kind))
    return ROS_TYPES[kind]


atlas_msgs: _Types = {
    name: _ros_type(getattr(ours, name))
    for name in ours.__all__
    if name.startswith("Atlas")
}

JOINT_ARRAYS = tuple(
    field.name
    for field in fields(ours.AtlasCommand)
    if isinstance(getattr(ours.AtlasCommand(), field.name), list)
    and field.name not in BYTES
)
"""Arrays of numbers, one for each joint, of a command to joints."""
osrf_msgs = _package(
    "osrf_msgs",
    JointCommands={"header": Header, "name": list, **dict.fromkeys(JOINT_ARRAYS, list)},
)

PACKAGES: dict[str, _Types] = {
    "atlas_msgs": atlas_msgs,
    "geometry_msgs": geometry_msgs,
    "osrf_msgs": osrf_msgs,
    "rosgraph_msgs": rosgraph_msgs,
    "sensor_msgs": sensor_msgs,
    "std_msgs": std_msgs,
}
"""Message packages, each with a module ``msg``."""


def with_joints_of(robot: Robot, types: _Types) -> _Types:
    """Return the types with this robot's joint indices in ``AtlasState``."""
    indices = {
        name: index
        for index, joint in enumerate(robot.file.joints)
        for name in (joint.alias, joint.name)
        if name
    }
    base = types["AtlasState"]
    own = type("AtlasState", (base,), {"__slots__": (), **indices})
    return {**types, "AtlasState": own}


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
    result = ROS_TYPES[type(message)]()
    for field in fields(message):  # type: ignore[arg-type]
        if field.name not in NOT_IN_ROS:
            value = getattr(message, field.name)
            setattr(result, field.name, _value_to_ros(field.name, value))
    return result


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
    return int(value) if isinstance(value, int) else value  # An enumeration's.
