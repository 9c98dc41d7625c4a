"""The behaviors of the original interface, by number and name.

The catalog of all behaviors, including the user's own, is in ``behavior_catalog``.
"""

from enum import IntEnum
from functools import cache
from typing import Any

_WHOLE = tuple("bcdnoxX")
"""Format specification types for whole numbers."""


class Behavior(IntEnum):
    """Values of ``AtlasSimInterfaceCommand.behavior``."""

    NONE = 0
    """No behavior, controls disabled."""
    FREEZE = 1
    """Safety: hold still."""
    STAND_PREP = 2
    """Go to the pose from which STAND can begin."""
    STAND = 3
    """Balance on both feet."""
    WALK = 4
    """Walk dynamically over a queue of steps."""
    STEP = 5
    """Take one quasi-static step at a time."""
    MANIPULATE = 6
    """Balance with a servoed pelvis."""
    USER = 7
    """All joints return to the user at once."""

    @staticmethod
    @cache
    def named(number: int, name: str) -> "Behavior":
        """Return the member of that name, or a value beside the members.

        A user's own behavior is such a value: it has a name and a number as members do.
        Two values are equal if their numbers are equal, and the same object if name and
        number are equal.

        Args:
            number: Number of the behavior.
            name: Name of the behavior in capitals.
        """
        if name in Behavior.__members__:
            return Behavior[name]
        value = int.__new__(Behavior, number)
        value._name_, value._value_ = name, number
        return value

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        return Behavior.named, (self._value_, self._name_)

    def __deepcopy__(self, _memo: object) -> "Behavior":
        return self

    def __str__(self) -> str:
        """Return the name, for readers; ``int`` returns the number."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Format the name, or the number if the specification is for a whole number."""
        return format(int(self) if spec[-1:] in _WHOLE else self.name, spec)
