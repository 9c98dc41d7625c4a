"""The behaviors that can be asked for, by number or by name.

What a behavior does, and from which other it may follow, is not decided here.
"""

from enum import IntEnum

from atlas_drake.errors import ErrorCode, InvalidMessageError, did_you_mean, shown
from atlas_drake.numeric import is_whole

_WHOLE = tuple("bcdnoxX")
"""Types of format specifications that are for whole numbers."""


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

    def __str__(self) -> str:
        """Give the name, which is what a reader wants; ``int`` gives the number."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Format the name, unless the specification is for a whole number."""
        return format(int(self) if spec[-1:] in _WHOLE else self.name, spec)


def behavior_from(value: object, field: str = "behavior") -> Behavior:
    """Find the behavior that a message asks for.

    Args:
        value: A ``Behavior``, its number, or its name in any case; hyphens and spaces
            in a name count as underscores.
        field: Path of the value in its message, for the error.

    Returns:
        The behavior.

    Raises:
        InvalidMessageError: If there is no such behavior; code NO_SUCH_BEHAVIOR.
    """
    hint = ""
    if isinstance(value, str):
        name = value.strip().upper().replace("-", "_").replace(" ", "_")
        if name in Behavior.__members__:
            return Behavior[name]
        hint = did_you_mean(name, Behavior.__members__)
    elif is_whole(value) and value in Behavior.__members__.values():
        return Behavior(value)
    known = ", ".join(f"{member.name} ({member.value})" for member in Behavior)
    raise InvalidMessageError(
        field,
        value,
        f"there is no behavior {shown(value)}.{hint} Known are {known}.",
        ErrorCode.NO_SUCH_BEHAVIOR,
    )
