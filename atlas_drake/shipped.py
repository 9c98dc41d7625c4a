"""The list of all behaviors that the project ships, and so of its parts with one.

To ship another behavior, add the entry of its folder in ``parts`` here: its
configuration is then a field of the controller, and commands, figures, log, page and
reference know it. A behavior of your own enters by ``behaviors=`` in the same way.
"""

from collections.abc import Iterable

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entries import FREEZE, NONE, STAND, STAND_PREP, USER, WALK
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import checked_entries
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.parts.manipulate.entry import MANIPULATE
from atlas_drake.parts.step.entry import STEP

BEHAVIORS = checked_entries(
    (NONE, FREEZE, STAND_PREP, STAND, WALK, STEP, MANIPULATE, USER), ()
)
"""Their entries, in the order of display."""
CATALOG = BehaviorCatalog(BEHAVIORS)
"""For commands and viewers."""
CONTROLLER = ControllerConfig().with_behaviors(BEHAVIORS)
"""Defaults of the controller, for a robot of Atlas' size."""


def registered(behaviors: Iterable[BehaviorEntry]) -> tuple[BehaviorEntry, ...]:
    """Returns the entries of the user's own behaviors after checking names and places.

    Raises:
        BehaviorError: Naming the entry and the field that cannot be used.
    """
    return checked_entries(behaviors, BEHAVIORS)


def shipped_entry(behavior: Behavior) -> BehaviorEntry:
    """Returns the entry of a shipped behavior, from which you can make your own.

    Example:
        >>> walk = shipped_entry(Behavior.WALK)
        >>> replace(walk, name="MARCH", number=100, make=March, follows=("STAND",))

    Args:
        behavior: A behavior of the original interface.
    """
    return next(entry for entry in BEHAVIORS if entry.behavior is behavior)
