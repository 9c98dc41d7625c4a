"""The modules that stand in for those of ROS.

Their contents are in the other files of this folder. A missing name raises an error
that lists the names of the module.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType
from typing import Any

from atlas_drake.robot import Robot
from atlas_drake.ros_scripts import poses
from atlas_drake.ros_scripts.message_types import PACKAGES, with_joints_of
from atlas_drake.ros_scripts.unknown import UnknownNameError, unknown


class StandIn(ModuleType):
    """A module whose errors list its names."""

    def __init__(self, name: str, content: Mapping[str, Any]) -> None:
        """Makes a module with ``content``, by name."""
        super().__init__(name, f"Stands in for the module {name}.")
        self.__path__: list[str] = []
        self.names = sorted(content)
        self.__all__ = self.names
        vars(self).update(content)

    def __getattr__(self, name: str) -> Any:
        # Python itself looks up such names.
        if name.startswith("__"):
            raise AttributeError(name)
        what = f"{self.__name__}.{name}"
        raise unknown(what, name, self.names, UnknownNameError)


def stand_ins(rospy: Mapping[str, Any], robot: Robot) -> dict[str, StandIn]:
    """Return all modules of ROS by full name.

    Args:
        rospy: Contents of ``rospy``.
        robot: Robot whose joints ``AtlasState`` names.
    """
    contents: dict[str, Mapping[str, Any]] = {
        "PyKDL": poses.KDL,
        "roslib": {"load_manifest": lambda *_packages: None},
        "rospy": rospy,
        "tf": {},
        "tf.transformations": poses.TRANSFORMATIONS,
        "tf_conversions": poses.POSEMATH,
        "tf_conversions.posemath": poses.POSEMATH,
    }
    for package, types in PACKAGES.items():
        own = with_joints_of(robot, types) if "AtlasState" in types else types
        contents |= {package: {}, f"{package}.msg": own}
    modules: dict[str, StandIn] = {}
    for name in sorted(contents):  # Packages come before their modules.
        modules[name] = StandIn(name, contents[name])
        package, _, last = name.rpartition(".")
        if package:
            setattr(modules[package], last, modules[name])
            modules[package].names.append(last)
    return modules
