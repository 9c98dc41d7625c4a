"""The robot's messages that a program can import, and their conversion, by field.

The fields of ``atlas_msgs`` are derived from the messages of this package, so that each
field is listed once. The general messages of ROS are in ``ros_types``.

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
from atlas_drake.clients.ros_scripts.ros_message import (
    Factory,
    RosMessage,
    Time,
    array_of,
    message_type,
)
from atlas_drake.clients.ros_scripts.ros_types import (
    GENERAL,
    Header,
    Types,
    action_types,
    geometry_msgs,
    package,
    sensor_msgs,
)
from atlas_drake.messages import Behavior, Message
from atlas_drake.robot import Robot

M = TypeVar("M", bound=Message)

NOT_IN_ROS = {"params", "feedback"}
"""Fields of this package's messages that the original does not have."""
BY_NAME = {
    "desired_step_spec",
    "desired_step_spec_saturated",
    "use_relative_step_height",
    "use_spec",
}
"""Fields of the robot's interface that the messages of DRCSim did not have."""
BYTES = {"k_effort"}
"""Fields that are ``uint8[]``, which ROS hands out as bytes."""

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
        ROS_TYPES[kind] = message_type(name, content, _constants(kind), BY_NAME)
    return ROS_TYPES[kind]


atlas_msgs: Types = {
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
osrf_msgs = package(
    "osrf_msgs",
    JointCommands={"header": Header, "name": list, **dict.fromkeys(JOINT_ARRAYS, list)},
)

_STATE = atlas_msgs["AtlasSimInterfaceState"]
GOAL_BEHAVIORS = {
    name: Behavior[name]
    for name in ("STAND", "USER", "FREEZE", "STAND_PREP", "WALK", "STEP", "MANIPULATE")
}
"""Behaviors of a goal; their numbers there are their places in this table."""
WalkDemoGoal = message_type(
    "atlas_msgs/WalkDemoGoal",
    {
        "header": Header,
        "behavior": int,
        "steps": list,
        "step_params": atlas_msgs["AtlasBehaviorStepParams"],
        "stand_params": atlas_msgs["AtlasBehaviorStandParams"],
        "manipulate_params": atlas_msgs["AtlasBehaviorManipulateParams"],
        "k_effort": bytes,
    },
    {name: number for number, name in enumerate(GOAL_BEHAVIORS)},
)
atlas_msgs |= action_types(
    "atlas_msgs/WalkDemo",
    Goal=WalkDemoGoal,
    Result=message_type(
        "atlas_msgs/WalkDemoResult", {"end_state": _STATE, "success": bool}
    ),
    Feedback=message_type("atlas_msgs/WalkDemoFeedback", {"state": _STATE}),
)

PACKAGES = {**GENERAL, "atlas_msgs": atlas_msgs, "osrf_msgs": osrf_msgs}
"""Message packages, each with a module ``msg``."""


def with_joints_of(robot: Robot, types: Types) -> Types:
    """Return the types with this robot's joint indices in ``AtlasState``."""
    content = {"__slots__": (), **vars(robot.joints)}
    own = type("AtlasState", (types["AtlasState"],), content)
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
