"""The general messages of ROS that a program can import, by package.

Those of the robot are in ``message_types``.
"""

from __future__ import annotations

from atlas_drake.clients.ros_scripts.ros_message import (
    Duration,
    Factory,
    RosMessage,
    Time,
    array_of,
    message_type,
)

Types = dict[str, type[RosMessage]]
"""The messages of a package, by their short names."""


def package(name: str, **types: dict[str, Factory]) -> Types:
    """Make the messages of a package, from the makers of their fields."""
    return {
        short: message_type(f"{name}/{short}", fields)
        for short, fields in types.items()
    }


_XYZ: dict[str, Factory] = dict.fromkeys("xyz", float)
_NINE = array_of(float, 9)
_PLAIN: dict[str, Factory] = {
    "Bool": bool,
    **dict.fromkeys(("Int8", "Int16", "Int32", "Int64"), int),
    **dict.fromkeys(("UInt8", "UInt16", "UInt32", "UInt64"), int),
    **dict.fromkeys(("Float32", "Float64"), float),
    "String": str,
}

std_msgs = package(
    "std_msgs",
    Empty={},
    Header={"seq": int, "stamp": Time, "frame_id": str},
    **{name: {"data": kind} for name, kind in _PLAIN.items()},
)
Header = std_msgs["Header"]
geometry_msgs = package(
    "geometry_msgs", Point=_XYZ, Vector3=_XYZ, Quaternion=dict.fromkeys("xyzw", float)
)
_Point, _Vector3, _Quaternion = geometry_msgs.values()
geometry_msgs |= package(
    "geometry_msgs",
    Pose={"position": _Point, "orientation": _Quaternion},
    Twist={"linear": _Vector3, "angular": _Vector3},
    Wrench={"force": _Vector3, "torque": _Vector3},
)
sensor_msgs = package(
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
    Joy={"header": Header, "axes": list, "buttons": list},
)
trajectory_msgs = package(
    "trajectory_msgs",
    JointTrajectory={"header": Header, "joint_names": list, "points": list},
    JointTrajectoryPoint={
        **dict.fromkeys(("positions", "velocities", "accelerations", "effort"), list),
        "time_from_start": Duration,
    },
)
rosgraph_msgs = package("rosgraph_msgs", Clock={"clock": Time})
actionlib_msgs = package("actionlib_msgs", GoalID={"stamp": Time, "id": str})
_STATES = "PENDING ACTIVE PREEMPTED SUCCEEDED ABORTED REJECTED PREEMPTING RECALLING"
GOAL_STATUS = {
    name: number for number, name in enumerate((*_STATES.split(), "RECALLED", "LOST"))
}
"""States of a goal, by name."""
GoalStatus = message_type(
    "actionlib_msgs/GoalStatus",
    {"goal_id": actionlib_msgs["GoalID"], "status": int, "text": str},
    GOAL_STATUS,
)
actionlib_msgs["GoalStatus"] = GoalStatus
std_srvs = package("std_srvs", Empty={}, EmptyRequest={}, EmptyResponse={})

GENERAL: dict[str, Types] = {
    "actionlib_msgs": actionlib_msgs,
    "geometry_msgs": geometry_msgs,
    "rosgraph_msgs": rosgraph_msgs,
    "sensor_msgs": sensor_msgs,
    "std_msgs": std_msgs,
    "trajectory_msgs": trajectory_msgs,
}
"""Message packages, each with a module ``msg``."""


def action_types(name: str, **parts: type[RosMessage]) -> Types:
    """Make the messages of an action, from ``Goal``, ``Result`` and ``Feedback``."""
    sent = {
        part: message_type(
            f"{name}Action{part}",
            {
                "header": Header,
                **(
                    {"goal_id": actionlib_msgs["GoalID"]}
                    if part == "Goal"
                    else {"status": GoalStatus}
                ),
                part.lower(): kind,
            },
        )
        for part, kind in parts.items()
    }
    action = {f"action_{part.lower()}": kind for part, kind in sent.items()}
    types = [message_type(f"{name}Action", action), *sent.values(), *parts.values()]
    return {kind.__name__: kind for kind in types}
