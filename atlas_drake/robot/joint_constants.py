"""Indices of a robot's joints in the arrays of a message, as constants.

``AtlasState.neck_ry`` and similar constants exist for the tutorial's Atlas only; these
exist for every robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from atlas_drake.errors import did_you_mean
from atlas_drake.robot.file import JointEntry


class JointConstants:
    """Index of each joint in message order, by name and by alias, as attributes.

    They cannot be changed; ``dir`` lists them.
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
        """Returns the index of a joint.

        Raises:
            AttributeError: If the robot has no such joint.
        """
        # While the object is copied, its own attributes are not there yet.
        places: dict[str, int] = self.__dict__.get("_places", {})
        if name not in places:
            robot = self.__dict__.get("_robot", "")
            hint = did_you_mean(name, places)
            raise AttributeError(f"robot '{robot}' has no joint '{name}'.{hint}")
        return places[name]

    def __setattr__(self, name: str, value: object) -> None:
        """Refuses every change.

        Raises:
            AttributeError: Always.
        """
        raise AttributeError(f"{name}: the joints of a robot are constants")

    def __dir__(self) -> Iterator[str]:
        """Lists names and aliases."""
        return iter(self.__dict__["_places"])
