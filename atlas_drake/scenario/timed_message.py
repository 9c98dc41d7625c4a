"""Messages that a scenario sends by itself, each at its time.

The scheduler delivers them; the tutorial's own messages are in
``simulation.tutorial``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from atlas_drake.config import Configuration, NotNegative, checked, joined
from atlas_drake.errors import InvalidMessageError, ScenarioError
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Refusal,
    accept,
)
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.records.plain import message_from
from atlas_drake.robot import Robot

_KINDS: dict[str, type[Message]] = {
    "atlas_command": AtlasCommand,
    "atlas_sim_interface_command": AtlasSimInterfaceCommand,
}


@dataclass(frozen=True)
class TimedMessage(Configuration):
    """One message with the time at which it is sent."""

    time: NotNegative = 0.0
    """Time at which the message is sent [s]."""
    text: str = ""
    """Text that is shown to the user then."""
    atlas_command: dict[str, Any] = field(default_factory=dict)
    """Fields of an ``AtlasCommand``, such as ``{k_effort: 255}``; one number in the
    place of a list stands for all joints."""
    atlas_sim_interface_command: dict[str, Any] = field(default_factory=dict)
    """Fields of an ``AtlasSimInterfaceCommand``, such as ``{behavior: STAND}``,
    likewise; ``params`` has the fields of the parameters of a behavior of one's own."""

    def check(self) -> None:
        """Checks what can be checked without the robot."""
        given = [name for name in _KINDS if getattr(self, name)]
        if len(given) != 1:
            raise ScenarioError(
                "",
                given,
                f"must have one of {' and '.join(_KINDS)}, not "
                f"{'both' if given else 'neither'}",
            )
        self._made(1, "")

    def message(
        self,
        robot: Robot,
        path: str,
        catalog: BehaviorCatalog = SHIPPED,
    ) -> AtlasCommand | AtlasSimInterfaceCommand:
        """Return the message for a robot.

        Args:
            robot: The robot.
            path: Where the message is in its scenario.
            catalog: The behaviors that can be asked for.

        Raises:
            ScenarioError: If the robot would refuse the message; it names the field.
        """
        name, made = self._made(robot.num_joints, path)
        try:
            if isinstance(made, AtlasSimInterfaceCommand):
                _take_params(made, catalog, f"{path}.{name}.params")
            outcome = accept(made, robot, catalog)
            if isinstance(outcome, Refusal):
                raise outcome.error
        except InvalidMessageError as error:
            raise ScenarioError(
                f"{path}.{name}.{error.field}", error.value, error.problem
            ) from None
        return made

    def _made(self, num_joints: int, path: str) -> tuple[str, Any]:
        """The message, not checked, and the name of its field."""
        (name,) = (one for one in _KINDS if getattr(self, one))
        try:
            plain = getattr(self, name)
            return name, message_from(_KINDS[name], plain, num_joints=num_joints)
        except InvalidMessageError as error:
            raise ScenarioError(
                joined(path, f"{name}.{error.field}"), error.value, error.problem
            ) from None


def _take_params(
    message: AtlasSimInterfaceCommand, catalog: BehaviorCatalog, path: str
) -> None:
    """Makes the parameters of a user's own behavior from their fields.

    Raises:
        InvalidMessageError: If there is no such behavior.
        ScenarioError: Naming the first field that cannot be used.
    """
    entry = catalog.entry(catalog.find(message.behavior))
    reads_params = entry.params is not None and entry.params_field == "params"
    if reads_params and isinstance(message.params, Mapping):
        message.params = checked(entry.params, message.params, path, from_text=True)
