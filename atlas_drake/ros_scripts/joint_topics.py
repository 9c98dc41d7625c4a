"""Topics that name joints: ``JointState`` out, ``JointCommands`` in.

``JointCommands`` is older than ``AtlasCommand``. It names the joints, in the v1 or the
v3 names, with or without the prefix ``atlas::``, and has no ``k_effort``: its sender
controls the named joints.
"""

from __future__ import annotations

from typing import Any

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand
from atlas_drake.robot import Robot
from atlas_drake.ros_scripts.message_types import JOINT_ARRAYS, sensor_msgs
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Time
from atlas_drake.ros_scripts.unknown import ScriptError
from atlas_drake.simulation import AtlasSimulation


def joint_states(sim: AtlasSimulation) -> RosMessage:
    """Return names, positions, velocities and efforts of all joints."""
    state = sim.atlas_state
    message: Any = sensor_msgs["JointState"]()
    message.header.stamp = Time.from_sec(state.header.stamp or 0.0)
    message.name = list(sim.robot.joint_names)
    message.position = list(state.position)
    message.velocity = list(state.velocity)
    message.effort = list(state.effort)
    return message


def joint_commands(sim: AtlasSimulation, message: RosMessage) -> None:
    """Send an ``AtlasCommand`` that puts the named joints under user control.

    Other joints, and arrays that the message leaves empty, keep the values in force.

    Raises:
        ScriptError: If a name is not a joint of the robot, or an array does not have
            one number per name.
    """
    given: Any = message
    indices = [_index(sim.robot, str(name), i) for i, name in enumerate(given.name)]
    in_force = sim.output("commands").joints
    command = AtlasCommand()
    command.header.stamp = given.header.stamp.to_sec()
    for field in JOINT_ARRAYS:
        values = getattr(given, field)
        if len(values) == 0:
            continue
        if len(values) != len(indices):
            raise ScriptError(
                f"{field} of osrf_msgs/JointCommands must have {len(indices)} "
                f"elements, one per name, or none, has {len(values)}"
            )
        setattr(command, field, _at(indices, values, getattr(in_force, field)))
    command.k_effort = _at(indices, [K_EFFORT_MAX] * len(indices), in_force.k_effort)
    sim.publish(command)


def joint_name(name: str) -> str:
    """Return ``back_bkz`` for ``atlas::back_bkz``: without the name of the model."""
    return name.rpartition("::")[2]


def _index(robot: Robot, name: str, place: int) -> int:
    try:
        return robot.joint_index(joint_name(name))
    except RobotDescriptionError as error:
        problem = f"name[{place}] of osrf_msgs/JointCommands: {error.problem}"
        raise ScriptError(problem) from error


def _at(indices: list[int], values: Any, others: Any) -> list[Any]:
    """Return ``others`` with ``values`` at ``indices``."""
    result = list(others)
    for index, value in zip(indices, values, strict=True):
        result[index] = value
    return result
