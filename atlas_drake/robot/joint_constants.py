"""A robot's joints as constants: where each stands in the arrays of a message.

What ``AtlasState.neck_ry`` and its like are for the tutorial's Atlas, for any robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from atlas_drake.errors import did_you_mean
from atlas_drake.robot.file import JointEntry


class JointConstants:
    """Index of each joint in message order, by name and by alias, as attributes.

    They are those of one robot and cannot be changed; ``dir`` lists them.
    """

    def __init__(self, robot: str, joints: Iterable[JointEntry]) -> None:
        """Takes the robot's name, for errors, and its joints in message order."""
        places: dict[str, int] = {}
        for index, joint in enumerate(joints):
            # A joint without an alias has an empty one, which names nothing.
            places |= {name: index for name in (joint.name, joint.alias) if name}
        object.__setattr__(self, "_robot", robot)
        object.__setattr__(self, "_places", places)

    def __getattr__(self, name: str) -> int:
        """The joint's index.

        Raises:
            AttributeError: If the robot has no such joint.
        """
        # Before there are any, as while it is copied, nothing has a name.
        places: dict[str, int] = self.__dict__.get("_places", {})
        if name not in places:
            robot = self.__dict__.get("_robot", "")
            hint = did_you_mean(name, places)
            raise AttributeError(f"robot '{robot}' has no joint '{name}'.{hint}")
        return places[name]

    def __setattr__(self, name: str, value: object) -> None:
        """Refuses: a constant is one.

        Raises:
            AttributeError: Always.
        """
        raise AttributeError(f"{name}: the joints of a robot are constants")

    def __dir__(self) -> Iterator[str]:
        """Names and aliases."""
        return iter(self.__dict__["_places"])
