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

_SHARED: dict[type[Message], type[RosMessage]] = {
    ours.Header: Header,
    **{
        kind: geometry_msgs[kind.__name__]
        for kind in (ours.Vector3, ours.Quaternion, ours.Pose, ours.Twist, ours.Wrench)
    },
}
_BEHAVIORS: tuple[type[Message], ...] = (
    ours.AtlasBehaviorStepData,
    ours.AtlasBehaviorFootData,
    ours.AtlasBehaviorStepAction,
    ours.AtlasBehaviorStepSpec,
    ours.AtlasBehaviorWalkParams,
    ours.AtlasBehaviorStepParams,
    ours.AtlasBehaviorStandParams,
    ours.AtlasBehaviorPelvisServoParams,
    ours.AtlasBehaviorManipulateParams,
    ours.AtlasBehaviorFeedback,
    ours.AtlasBehaviorStandFeedback,
    ours.AtlasBehaviorStepFeedback,
    ours.AtlasBehaviorWalkFeedback,
    ours.AtlasBehaviorManipulateFeedback,
    ours.AtlasPositionData,
)
"""Parts of messages; each after the parts that it contains."""
_TOP: tuple[type[Message], ...] = (
    ours.AtlasCommand,
    ours.AtlasState,
    ours.AtlasSimInterfaceCommand,
    ours.AtlasSimInterfaceState,
)


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


def _factory(name: str, value: Any, types: dict[type[Message], Factory]) -> Factory:
    """Return the maker of a field's initial value, from the value in this package."""
    if name == "position" and isinstance(value, ours.Vector3):
        return geometry_msgs["Point"]
    if isinstance(value, Message):
        return types[type(value)]
    if isinstance(value, list) and value:
        return array_of(types[type(value[0])], len(value))
    if isinstance(value, list):
        return bytes if name in BYTES else list
    # Values of enumerations are numbers in ROS.
    return next(kind for kind in (bool, int, float, str) if isinstance(value, kind))


def _atlas() -> _Types:
    types: dict[type[Message], Any] = dict(_SHARED)
    made: _Types = {}
    for kind in (*_BEHAVIORS, *_TOP):
        empty = kind()
        content = {
            field.name: _factory(field.name, getattr(empty, field.name), types)
            for field in fields(kind)  # type: ignore[arg-type]
            if field.name not in NOT_IN_ROS
        }
        name = kind.__name__
        made[name] = message_type(f"atlas_msgs/{name}", content, _constants(kind))
        types[kind] = made[name]
    return made


atlas_msgs = _atlas()

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

PACKAGES: dict[str, _Types] = {
    "atlas_msgs": atlas_msgs,
    "geometry_msgs": geometry_msgs,
    "osrf_msgs": osrf_msgs,
    "rosgraph_msgs": rosgraph_msgs,
    "sensor_msgs": sensor_msgs,
    "std_msgs": std_msgs,
}
"""Message packages, each with a module ``msg``."""

ROS_TYPES: dict[type[Message], type[RosMessage]] = {
    **_SHARED,
    **{kind: atlas_msgs[kind.__name__] for kind in (*_BEHAVIORS, *_TOP)},
    ours.Imu: sensor_msgs["Imu"],
}
"""The ROS message for each message of this package."""


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
