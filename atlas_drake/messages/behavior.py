"""The numbers of the interface: behaviors, their status flags, settings of a step.

The catalog of all behaviors, including the user's own, is in ``behavior_catalog``.
"""

from enum import IntEnum, IntFlag
from functools import cache
from typing import Any


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
        """
        if name in Behavior.__members__:
            return Behavior[name]
        value = int.__new__(Behavior, number)
        value._name_, value._value_ = name, number
        return value

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        return Behavior.named, (self._value_, self._name_)

    def __str__(self) -> str:
        """Return the name, for readers; ``int`` returns the number."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Format the name."""
        return format(self.name, spec)


class BehaviorStatus(IntFlag):
    """Bits of ``AtlasBehaviorFeedback.status_flags``."""

    OK = 0
    """Nothing to report."""
    TRANSITION_IN_PROGRESS = 1
    """A transition is pending: the behavior that is left completes its motion first."""
    TRANSITION_SUCCESS = 2
    """The requested behavior is active."""
    FAILED_TRANS_UNKNOWN_BEHAVIOR = 4
    """The requested behavior does not exist."""
    FAILED_TRANS_ILLEGAL_BEHAVIOR = 8
    """The requested behavior may not follow the active one."""
    FAILED_TRANS_COM_POS = 16
    """The center of mass is not over the feet, or the robot falls or lies."""
    FAILED_TRANS_COM_VEL = 32
    """The center of mass moves too fast."""
    FAILED_TRANS_VEL = 64
    """A joint moves too fast."""
    WARNING_AUTO_TRANS = 128
    """The behavior ended by itself, and STAND followed."""
    ERROR_FALLING = 256
    """The robot falls or lies on the ground; its motors only damp its joints."""


class WalkStatus(IntFlag):
    """Bits of ``AtlasBehaviorWalkFeedback.status_flags``."""

    OKAY = 0
    """Nothing to report."""
    SUBSTATE_SWAYING = 1
    """The weight moves over the first stance foot."""
    SUBSTATE_STEPPING = 2
    """The robot takes steps."""
    SUBSTATE_CATCHING = 4
    """The last step is taken, and the robot comes to rest."""
    WARNING_INSUFFICIENT_STEP_DATA = 8
    """There was no next step in time: the walk ends."""
    ERROR_INCONSISTENT_STEPS = 16
    """The next step cannot follow: it is for the same foot again, leads too far up or
    down, or to another level out of reach. The walk ends."""


class StepStatus(IntFlag):
    """Bits of ``AtlasBehaviorStepFeedback.status_flags``."""

    OKAY = 0
    """Nothing to report."""
    SUBSTATE_SWAYING = 1
    """The weight moves over the stance foot, or back."""
    SUBSTATE_STEPPING = 2
    """A foot is in the air."""


class ToeOff(IntEnum):
    """Values of ``AtlasBehaviorStepAction.toe_off``."""

    DISABLE = 0
    """Both soles stay flat."""
    ENABLE = 1
    """The heel of the trailing foot may rise if the leg would be too short."""
    FORCE_ENABLE = 2
    """The heel of the trailing foot rises in every step."""
