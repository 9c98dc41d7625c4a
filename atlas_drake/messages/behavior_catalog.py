"""The catalog of behaviors, for commands and viewers.

Name, number and parameters; color and description. The control laws and entry
conditions of a behavior are in ``behaviors``.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterable, Iterator
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
    shown,
)
from atlas_drake.frozen import Frozen
from atlas_drake.messages.atlas_sim_interface_command import AtlasSimInterfaceCommand
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
_NAME = re.compile(r"[A-Z][A-Z0-9_]*")
_COLOR = re.compile(r"#[0-9a-fA-F]{6}")


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


@dataclass(frozen=True)
class BehaviorCatalog(Frozen):
    """All behaviors of a controller.

    Attributes:
        entries: The behaviors in the order of display.
    """

    entries: tuple[BehaviorInterface, ...]

    def __post_init__(self) -> None:
        """Check that names and numbers are valid and unique.

        Raises:
            BehaviorError: If they are not.
        """
        names: dict[str, BehaviorInterface] = {}
        numbers: dict[int, BehaviorInterface] = {}
        for entry in self.entries:
            _check_sound(entry)
            for known, key in ((names, entry.name), (numbers, entry.number)):
                if key in known:
                    raise BehaviorError(
                        f"behavior {entry.name} ({entry.number}): "
                        f"{known[key].name} ({known[key].number}) "  # type: ignore[index]
                        "is registered already; choose another name and number"
                    )
                known[key] = entry  # type: ignore[index]

    def __iter__(self) -> Iterator[BehaviorInterface]:
        return iter(self.entries)

    def __contains__(self, behavior: object) -> bool:
        return behavior in self._by_behavior

    @cached_property
    def _by_behavior(self) -> dict[Behavior, BehaviorInterface]:
        return {entry.behavior: entry for entry in self.entries}

    @cached_property
    def _by_key(self) -> dict[str | int, BehaviorInterface]:
        names = {entry.name: entry for entry in self.entries}
        return names | {entry.number: entry for entry in self.entries}

    def entry(self, behavior: Behavior) -> BehaviorInterface:
        """Return the entry of a behavior of this catalog."""
        return self._by_behavior[behavior]

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
        """Check the requested behavior, and parameters by the behaviors' own checks.

        Raises:
            InvalidMessageError: If anything in them cannot be applied; it names the
                field.
        """
        asked = self.entry(self.find(message.behavior))
        reads_params = asked.params is not None and asked.params_field == "params"
        if message.params is not None and not reads_params:
            reads = (
                f"reads {asked.params_field}" if asked.params else "has no parameters"
            )
            raise InvalidMessageError(
                "params",
                message.params,
                f"is for the user's own behaviors; {asked.name} {reads}",
            )
        for entry in self.entries:
            # The fields of the original interface count for any requested behavior.
            if entry.params is not None and entry.params_field != "params":
                _check(entry, getattr(message, entry.params_field))
        if message.params is not None:
            _check(asked, message.params)


def _check(entry: BehaviorInterface, params: object) -> None:
    assert entry.params is not None
    if not isinstance(params, entry.params):
        problem = f"must be {entry.params.__name__}, is {type(params).__name__}"
        raise InvalidMessageError(entry.params_field, params, problem)
    if entry.check is None:
        return
    try:
        entry.check(params, entry.params_field)
    except InvalidMessageError:
        raise
    except Exception as error:
        # An exception in a user's check must not end the simulation.
        raise InvalidMessageError(
            entry.params_field,
            params,
            f"the check of {entry.name} failed with {type(error).__name__}: {error}",
        ) from error


def _check_sound(entry: BehaviorInterface) -> None:
    """Check that an entry can be used.

    Raises:
        BehaviorError: If not; it names the entry and the problem.
    """
    label = f"behavior {entry.name!r}"
    if not (isinstance(entry.name, str) and _NAME.fullmatch(entry.name)):
        raise BehaviorError(f"{label}: a name has capitals, digits and underscores")
    shipped = entry.name in Behavior.__members__
    if shipped and Behavior[entry.name] != entry.number:
        raise BehaviorError(f"{label} is one of the original interface")
    least = 0 if shipped else FIRST_NUMBER
    if not is_whole(entry.number) or not least <= entry.number <= MAX_INDEX:
        raise BehaviorError(
            f"{label}: its number must be a whole number from {FIRST_NUMBER} to "
            f"{MAX_INDEX}, is {shown(entry.number)}"
        )
    if not (isinstance(entry.color, str) and _COLOR.fullmatch(entry.color)):
        raise BehaviorError(
            f"{label}: its color must be a hexadecimal color, such as '#7cb342', is "
            f"{shown(entry.color)}"
        )
    if entry.params is not None and not (
        isinstance(entry.params, type) and dataclasses.is_dataclass(entry.params)
    ):
        raise BehaviorError(
            f"{label}: params must be a dataclass, is {shown(entry.params)}"
        )


def _shipped() -> Iterable[BehaviorInterface]:
    """The behaviors of the original interface."""
    for behavior, color, description in (
        (Behavior.NONE, "#9e9e9e", "No behavior, controls disabled."),
        (Behavior.FREEZE, "#4fc3d9", "Safety: hold still."),
        (Behavior.STAND_PREP, "#b39ddb", "Go to the pose from which STAND can begin."),
        (Behavior.STAND, "#7cb342", "Balance on both feet."),
        (Behavior.WALK, "#42a5f5", "Walk dynamically over a queue of steps."),
        (Behavior.STEP, "#26a69a", "Take one quasi-static step at a time."),
        (Behavior.MANIPULATE, "#ec407a", "Balance with a servoed pelvis."),
        (Behavior.USER, "#ffb74d", "All joints return to the user at once."),
    ):
        yield BehaviorInterface(
            name=behavior.name,
            number=behavior.value,
            color=color,
            description=description,
            params=_PARAMS.get(behavior),
            params_field=f"{behavior.name.lower()}_params",
        )


_PARAMS: dict[Behavior, type] = {
    Behavior.WALK: AtlasBehaviorWalkParams,
    Behavior.STEP: AtlasBehaviorStepParams,
    Behavior.STAND: AtlasBehaviorStandParams,
    Behavior.MANIPULATE: AtlasBehaviorManipulateParams,
}
SHIPPED = BehaviorCatalog(tuple(_shipped()))
"""The behaviors of the original interface."""
