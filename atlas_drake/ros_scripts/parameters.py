"""Parameters: the default gains of the robot's joints, and those that a program sets.

Used by ``rospy.get_param`` and the related functions.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from atlas_drake.ros_scripts.joint_topics import joint_name
from atlas_drake.ros_scripts.unknown import UnknownNameError, unknown
from atlas_drake.simulation import AtlasSimulation

GAINS = "atlas_controller/gains"
"""Path of the joint controllers' default gains: .../JOINT/p, i, d, i_clamp."""
_NOT_GIVEN = object()


class NoParameterError(UnknownNameError, KeyError):
    """A parameter that does not exist, requested without a default."""

    def __str__(self) -> str:
        """Return the message without the quotes of ``KeyError``."""
        return str(self.args[0])


class Parameters:
    """The parameters of one run."""

    def __init__(self, sim: AtlasSimulation, resolve: Callable[[str], str]) -> None:
        """Reads the robot's gains, by the v3 and the v1 names of the joints.

        Args:
            sim: The simulation.
            resolve: Returns the full name of a parameter, such as ``/node/x`` of
                ``~x``.
        """
        robot = sim.robot
        gains: dict[str, Any] = {}
        for joint, kp, kd in zip(
            robot.file.joints, robot.default_kp, robot.default_kd, strict=True
        ):
            own = {"p": float(kp), "i": 0.0, "d": float(kd), "i_clamp": 0.0}
            for name in filter(None, (joint.name, joint.alias)):
                gains[name] = own
        self._resolve = resolve
        self._tree: dict[str, Any] = {"use_sim_time": True}
        self.set(f"/{GAINS}", gains)

    def get(self, name: str, default: Any = _NOT_GIVEN) -> Any:
        """Returns a parameter, or a dict of all in a group.

        Raises:
            NoParameterError: If it does not exist and no default is given.
        """
        value: Any = self._tree
        for part in self._path(name):
            if not isinstance(value, dict) or part not in value:
                if default is not _NOT_GIVEN:
                    return default
                known = [*self._tree, f"{GAINS}/JOINT/p"]
                raise unknown(f"parameter {name!r}", name, known, NoParameterError)
            value = value[part]
        return copy.deepcopy(value)

    def has(self, name: str) -> bool:
        """Tells whether a parameter or a group exists."""
        return self.get(name, self) is not self

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter, or by a dict a group; the robot does not read it."""
        *groups, last = self._path(name)
        group = self._tree
        for part in groups:
            if not isinstance(group.get(part), dict):
                group[part] = {}
            group = group[part]
        group[last] = copy.deepcopy(value)

    def _path(self, name: str) -> list[str]:
        parts = self._resolve(name).split("/")
        return [joint_name(part) for part in parts if part]
