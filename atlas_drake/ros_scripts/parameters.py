"""Parameters: the default gains of the robot's joints, and those that a program sets.

Used by ``rospy.get_param`` and the related functions.
"""

from __future__ import annotations

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

    def __init__(self, sim: AtlasSimulation) -> None:
        """Reads the robot's gains, by the v3 and the v1 names of the joints."""
        robot = sim.robot
        gains: dict[str, Any] = {}
        for joint, kp, kd in zip(
            robot.file.joints, robot.default_kp, robot.default_kd, strict=True
        ):
            own = {"p": float(kp), "i": 0.0, "d": float(kd), "i_clamp": 0.0}
            for name in filter(None, (joint.name, joint.alias)):
                gains[name] = own
        self._values: dict[str, Any] = {"use_sim_time": True, GAINS: gains}

    def get(self, name: str, default: Any = _NOT_GIVEN) -> Any:
        """Returns a parameter, or a dict of all in a group.

        Raises:
            NoParameterError: If it does not exist and no default is given.
        """
        key = _key(name)
        if key in self._values:
            return self._values[key]
        *rest, last = key.removeprefix(f"{GAINS}/").split("/")
        gains = self._values[GAINS]
        if key.startswith(f"{GAINS}/"):
            joint = joint_name(rest[0] if rest else last)
            if joint in gains and not rest:
                return dict(gains[joint])
            if joint in gains and len(rest) == 1 and last in gains[joint]:
                return gains[joint][last]
        if default is not _NOT_GIVEN:
            return default
        known = [*self._values, f"{GAINS}/JOINT/p"]
        raise unknown(f"parameter {name!r}", key, known, NoParameterError)

    def has(self, name: str) -> bool:
        """Tells whether a parameter exists."""
        return self.get(name, _ABSENT) is not _ABSENT

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter for the program's own use; the robot does not read it."""
        self._values[_key(name)] = value

    def delete(self, name: str) -> None:
        """Deletes a parameter."""
        self._values.pop(_key(name), None)

    def names(self) -> list[str]:
        """Returns the names of all parameters."""
        return sorted("/" + name for name in self._values)


_ABSENT = object()


def _key(name: str) -> str:
    return str(name).lstrip("/~")
