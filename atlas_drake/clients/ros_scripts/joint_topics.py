"""Topics that move joints by name: commands, trajectories, controllers of one joint.

``JointCommands`` is older than ``AtlasCommand``: it names the joints, in the v1 or the
v3 names, with or without the prefix ``atlas::``, and has no ``k_effort``, because its
sender controls the named joints. The others become such commands.
"""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any

import numpy as np

from atlas_drake.clients.ros_scripts.clock import TOLERANCE
from atlas_drake.clients.ros_scripts.message_types import JOINT_ARRAYS, osrf_msgs
from atlas_drake.clients.ros_scripts.unknown import ScriptError
from atlas_drake.errors import InvalidMessageError, RobotDescriptionError
from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand
from atlas_drake.simulation import AtlasSimulation

JointCommands = osrf_msgs["JointCommands"]


def joint_name(name: str) -> str:
    """Return ``back_bkz`` for ``atlas::back_bkz``: without the name of the model."""
    return name.rpartition("::")[2]


def _indices(sim: AtlasSimulation, names: list[str], field: str) -> list[int]:
    try:
        return [sim.robot.joint_index(joint_name(name)) for name in names]
    except RobotDescriptionError as error:
        raise ScriptError(f"{field}: {error}") from error


def command_joints(sim: AtlasSimulation, message: Any) -> None:
    """Send an ``AtlasCommand`` that puts the named joints under user control.

    Other joints, and arrays that the message leaves empty, keep the values in force.
    """
    indices = _indices(sim, message.name, "name of osrf_msgs/JointCommands")
    in_force = sim.output("commands").joints
    command = AtlasCommand()
    command.header.stamp = message.header.stamp.to_sec()
    for field in JOINT_ARRAYS:
        values = getattr(message, field)
        if len(values) not in (0, len(indices)):
            raise ScriptError(
                f"{field} of osrf_msgs/JointCommands must have {len(indices)} "
                f"elements, one per name, or none, has {len(values)}"
            )
        if len(values):
            array = np.array(getattr(in_force, field))
            array[indices] = values
            setattr(command, field, array)
    k_effort = np.array(in_force.k_effort)
    k_effort[indices] = K_EFFORT_MAX
    command.k_effort = k_effort
    sim.publish(command)


def move_joint(joint: str, sim: AtlasSimulation, message: Any) -> str | None:
    """Send the position of one joint; returns a note if the robot has no such joint."""
    try:
        sim.robot.joint_index(joint)
    except RobotDescriptionError as error:
        return f"! /{joint}_position_controller/command: {error}"
    command_joints(sim, JointCommands(name=[joint], position=[message.data]))
    return None


class Trajectory:
    """Sends the positions of a ``JointTrajectory`` at their times.

    The plugin of the original took ``time_from_start`` for the time from a point to the
    next, and put the joints there, without physics. Here they are set-points.
    """

    def __init__(self, sim: AtlasSimulation, message: Any) -> None:
        """Checks the message; it begins at its stamp, or now if that is past."""
        _indices(sim, message.joint_names, "joint_names of JointTrajectory")
        self._names = list(message.joint_names)
        self._points: deque[tuple[float, list[float]]] = deque()
        time = max(sim.time, message.header.stamp.to_sec())
        for place, point in enumerate(message.points):
            if len(point.positions) != len(self._names):
                raise ScriptError(
                    f"points[{place}].positions of JointTrajectory must have "
                    f"{len(self._names)} elements, one per joint name, has "
                    f"{len(point.positions)}"
                )
            self._points.append((time, list(point.positions)))
            time += point.time_from_start.to_sec()

    def __call__(self, sim: AtlasSimulation) -> None:
        """Sends the latest point that is due; leaves the simulation after the last."""
        positions = None
        while self._points and self._points[0][0] <= sim.time + TOLERANCE:
            _, positions = self._points.popleft()
        if positions is not None:
            command = JointCommands(name=self._names, position=positions)
            with suppress(InvalidMessageError):  # The refusal is an event.
                command_joints(sim, command)
        if not self._points:
            sim.hooks.remove(self)


def follow_trajectory(sim: AtlasSimulation, message: Any) -> None:
    """Follow a trajectory from now on, in place of the present one."""
    trajectory = Trajectory(sim, message)
    sim.hooks[:] = [hook for hook in sim.hooks if not isinstance(hook, Trajectory)]
    sim.hooks.append(trajectory)
