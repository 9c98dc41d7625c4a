"""The catalog of behaviors, for commands and viewers.

Name, number and parameters; color and description. The control laws and entry
conditions of a behavior are in ``behaviors``.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from atlas_drake.config import is_whole
from atlas_drake.errors import (
    AtlasError,
    ErrorCode,
    InvalidMessageError,
    described,
    did_you_mean,
)
from atlas_drake.frozen import Frozen
from atlas_drake.messages.atlas_command import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_params import (
    AtlasBehaviorManipulateParams,
    AtlasBehaviorStandParams,
    AtlasBehaviorStepParams,
    AtlasBehaviorWalkParams,
)
from atlas_drake.messages.fields import MAX_INDEX

FIRST_NUMBER = 100
"""Lowest number of a user's own behavior; lower numbers belong to the original
interface."""


class BehaviorError(AtlasError):
    """A behavior that cannot be registered."""


@dataclass(frozen=True, kw_only=True)
class BehaviorInterface(Frozen):
    """Description of a behavior for commands and viewers.

    Attributes:
        name: In capitals, such as ``BOW``; commands ask for it by name or number.
        number: Value of ``AtlasSimInterfaceCommand.behavior``; ``FIRST_NUMBER`` or more
            for a user's own behavior.
        params: Dataclass of its parameters, all with defaults; None if it has none.
        check: Called with parameters and the path of their field before they are
            applied; raises ``InvalidMessageError`` for invalid parameters.
        color: Color in figures, such as ``#7cb342``.
        description: What the behavior does, in one sentence.
        params_field: Field of the command that holds the parameters.
    """

    name: str
    number: int
    params: type | None = None
    check: Callable[[Any, str], None] | None = None
    color: str = "#8d6e63"
    description: str = ""
    params_field: str = "params"

    @cached_property
    def behavior(self) -> Behavior:
        """The behavior's value in reports, requests and ``current_behavior``."""
        return Behavior.named(self.number, self.name)

    def faults(self) -> Iterator[str]:
        """Yields what prevents the registration of this entry."""
        if not re.fullmatch("[A-Z][A-Z0-9_]*", str(self.name)):
            yield "its name must have capitals, digits and underscores only"
        is_shipped = self.name in Behavior.__members__
        if is_shipped and Behavior[self.name] != self.number:
            yield "the original interface has a behavior of that name"
        lowest = 0 if is_shipped else FIRST_NUMBER
        if not is_whole(self.number) or not lowest <= self.number <= MAX_INDEX:
            yield f"its number must be a whole number from {FIRST_NUMBER}"
        if not re.fullmatch("#[0-9a-fA-F]{6}", str(self.color)):
            yield "its color must be a hexadecimal color, such as '#7cb342'"
        if self.params is not None and not (
            isinstance(self.params, type) and dataclasses.is_dataclass(self.params)
        ):
            yield "params must be a dataclass"

    def check_params(self, params: object) -> None:
        """Raises InvalidMessageError if the behavior cannot use these parameters."""
        assert self.params is not None
        if not isinstance(params, self.params):
            problem = f"must be {self.params.__name__}, is {type(params).__name__}"
            raise InvalidMessageError(self.params_field, params, problem)
        if self.check is None:
            return
        try:
            self.check(params, self.params_field)
        except InvalidMessageError:
            raise
        except Exception as error:
            # An exception in a user's check must not end the simulation.
            problem = f"the check of {self.name} failed with {error!r}"
            raise InvalidMessageError(self.params_field, params, problem) from error


@dataclass(frozen=True)
class BehaviorCatalog(Frozen):
    """All behaviors of a controller, in the order of display."""

    entries: tuple[BehaviorInterface, ...]

    def __post_init__(self) -> None:
        """Check that names and numbers are valid and unique."""
        known: dict[str | int, BehaviorInterface] = {}
        for entry in self.entries:
            label = f"behavior {entry.name!r} ({entry.number!r})"
            for fault in entry.faults():
                raise BehaviorError(f"{label}: {fault}")
            for key in (entry.name, entry.number):
                if key in known:
                    raise BehaviorError(
                        f"{label}: {known[key].name} ({known[key].number}) is "
                        "registered already; choose another name and number"
                    )
                known[key] = entry

    def __iter__(self) -> Iterator[BehaviorInterface]:
        return iter(self.entries)

    def __contains__(self, behavior: object) -> bool:
        return behavior in self._by_key

    @cached_property
    def _by_key(self) -> dict[str | int, BehaviorInterface]:
        names = {entry.name: entry for entry in self.entries}
        return names | {entry.number: entry for entry in self.entries}

    def entry(self, behavior: Behavior) -> BehaviorInterface:
        """Return the entry of a behavior of this catalog."""
        return self._by_key[behavior]

    def find(self, value: object, field: str = "behavior") -> Behavior:
        """Find the behavior that a message requests.

        Args:
            value: A ``Behavior``, its number, or its name in any case; hyphens and
                spaces in a name count as underscores.
            field: Path of the value in its message, for the error.

        Raises:
            InvalidMessageError: If there is no such behavior; code NO_SUCH_BEHAVIOR.
        """
        hint = ""
        if isinstance(value, str):
            name = value.strip().upper().replace("-", "_").replace(" ", "_")
            if name in self._by_key:
                return self._by_key[name].behavior
            hint = did_you_mean(name, [entry.name for entry in self.entries])
        elif is_whole(value) and int(value) in self._by_key:
            return self._by_key[int(value)].behavior
        known = ", ".join(f"{entry.name} ({entry.number})" for entry in self.entries)
        raise InvalidMessageError(
            field,
            value,
            f"there is no behavior {described(value)}.{hint} Known are {known}.",
            ErrorCode.NO_SUCH_BEHAVIOR,
        )

    def check_params(self, message: AtlasSimInterfaceCommand) -> None:
        """Check the requested behavior, and parameters by the behaviors' own checks."""
        requested = self.entry(self.find(message.behavior))
        for entry in self.entries:
            # The fields of the original interface count for any requested behavior.
            if entry.params is not None and entry.params_field != "params":
                entry.check_params(getattr(message, entry.params_field))
        if message.params is None:
            return
        if requested.params is None or requested.params_field != "params":
            problem = f"is for the user's own behaviors; {requested.name} has none"
            raise InvalidMessageError("params", message.params, problem)
        requested.check_params(message.params)


_PARAMS: dict[Behavior, type] = {
    Behavior.WALK: AtlasBehaviorWalkParams,
    Behavior.STEP: AtlasBehaviorStepParams,
    Behavior.STAND: AtlasBehaviorStandParams,
    Behavior.MANIPULATE: AtlasBehaviorManipulateParams,
}
SHIPPED = BehaviorCatalog(
    tuple(
        BehaviorInterface(
            name=behavior.name,
            number=behavior.value,
            color=color,
            description=description,
            params=_PARAMS.get(behavior),
            params_field=f"{behavior.name.lower()}_params"
            if behavior in _PARAMS
            else "params",
        )
        for behavior, color, description in (
            (Behavior.NONE, "#9e9e9e", "No behavior, controls disabled."),
            (Behavior.FREEZE, "#4fc3d9", "Safety: hold still."),
            (Behavior.STAND_PREP, "#b39ddb", "Go to the pose in which STAND begins."),
            (Behavior.STAND, "#7cb342", "Balance on both feet."),
            (Behavior.WALK, "#42a5f5", "Walk dynamically over a queue of steps."),
            (Behavior.STEP, "#26a69a", "Take one quasi-static step at a time."),
            (Behavior.MANIPULATE, "#ec407a", "Balance with a servoed pelvis."),
            (Behavior.USER, "#ffb74d", "All joints return to the user at once."),
        )
    )
)
"""The behaviors of the original interface."""
