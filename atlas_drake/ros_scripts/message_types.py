"""The messages that a program can import, by package.

The fields of ``atlas_msgs`` are derived from the messages of this package, so that each
field is listed once. Only the general messages of ROS are written out here.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from atlas_drake import messages as ours
from atlas_drake.messages import Message
from atlas_drake.robot import Robot
from atlas_drake.ros_scripts.ros_message import (
    Factory,
    RosMessage,
    array_of,
    message_type,
)
from atlas_drake.ros_scripts.ros_time import Time

NOT_IN_ROS = {"params", "feedback"}
"""Fields of this package's messages that the original does not have."""
BYTES = {"k_effort"}
"""Fields that are ``uint8[]``, which ROS hands out as bytes."""

_Types = dict[str, type[RosMessage]]

std_msgs: _Types = {
    "Header": message_type(
        "std_msgs/Header", {"seq": int, "stamp": Time, "frame_id": str}
    ),
    "String": message_type("std_msgs/String", {"data": str}),
}
Header = std_msgs["Header"]


def _geometry() -> _Types:
    types: _Types = {}

    def add(name: str, **content: Factory) -> None:
        types[name] = message_type(f"geometry_msgs/{name}", content)

    for name in ("Point", "Vector3"):
        add(name, x=float, y=float, z=float)
    add("Quaternion", x=float, y=float, z=float, w=float)
    add("Pose", position=types["Point"], orientation=types["Quaternion"])
    add("Twist", linear=types["Vector3"], angular=types["Vector3"])
    add("Wrench", force=types["Vector3"], torque=types["Vector3"])
    return types


geometry_msgs = _geometry()

ROS_TYPES: dict[type[Message], type[RosMessage]] = {
    ours.Header: Header,
    **{
        kind: geometry_msgs[kind.__name__]
        for kind in (ours.Vector3, ours.Quaternion, ours.Pose, ours.Twist, ours.Wrench)
    },
}
"""The ROS message for each message of this package; those of atlas_msgs join below."""
_ATLAS: list[type[Message]] = [
    getattr(ours, name) for name in ours.__all__ if name.startswith("Atlas")
]
"""The messages of ``atlas_msgs``."""


def _constants(kind: type) -> dict[str, int]:
    """Return all whole-number constants of a class and its bases."""
    found: dict[str, int] = {}
    for base in reversed(kind.__mro__):
        found |= {
            name: int(value)
            for name, value in vars(base).items()
            if isinstance(value, int) and not name.startswith("_")
        }
    return found


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


atlas_msgs: _Types = {kind.__name__: _ros_type(kind) for kind in _ATLAS}

_NINE = array_of(float, 9)
sensor_msgs: _Types = {
    "Imu": message_type(
        "sensor_msgs/Imu",
        {
            "header": Header,
            "orientation": geometry_msgs["Quaternion"],
            "orientation_covariance": _NINE,
            "angular_velocity": geometry_msgs["Vector3"],
            "angular_velocity_covariance": _NINE,
            "linear_acceleration": geometry_msgs["Vector3"],
            "linear_acceleration_covariance": _NINE,
        },
    ),
    "JointState": message_type(
        "sensor_msgs/JointState",
        {
            "header": Header,
            **dict.fromkeys(("name", "position", "velocity", "effort"), list),
        },
    ),
}
JOINT_ARRAYS = tuple(
    field.name
    for field in fields(ours.AtlasCommand)
    if isinstance(getattr(ours.AtlasCommand(), field.name), list)
    and field.name not in BYTES
)
"""Arrays of numbers, one for each joint, of a command to joints."""
osrf_msgs: _Types = {
    "JointCommands": message_type(
        "osrf_msgs/JointCommands",
        {"header": Header, "name": list, **dict.fromkeys(JOINT_ARRAYS, list)},
    )
}
rosgraph_msgs: _Types = {"Clock": message_type("rosgraph_msgs/Clock", {"clock": Time})}

ROS_TYPES[ours.Imu] = sensor_msgs["Imu"]

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
