"""Messages that a scenario sends by itself, each at its time.

The scheduler delivers them; the tutorial's own messages are in
``simulation.tutorial``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
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
from atlas_drake.messages.atlas_command import COMMANDS
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.records.plain import message_from
from atlas_drake.robot import Robot
from atlas_drake.shipped import CATALOG
from atlas_drake.units import Seconds


@dataclass(frozen=True)
class TimedMessage(Configuration):
    """One message with the time at which it is sent."""

    time: NotNegative[Seconds] = 0.0
    """Time at which the message is sent."""
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
        given = [name for name in COMMANDS if getattr(self, name)]
        if len(given) != 1:
            raise ScenarioError(
                "", given, f"must have exactly one of {' and '.join(COMMANDS)}"
            )
        self._made(1, "")

    def message(
        self,
        robot: Robot,
        path: str,
        catalog: BehaviorCatalog = CATALOG,
    ) -> AtlasCommand | AtlasSimInterfaceCommand:
        """Returns the message for a robot; ``path`` is its place in the scenario."""
        made = self._made(robot.num_joints, path)
        with self._naming(path):
            if isinstance(made, AtlasSimInterfaceCommand):
                where = joined(path, f"{self._kind}.params")
                _take_params(made, catalog, where)
            outcome = accept(made, robot, catalog)
            if isinstance(outcome, Refusal):
                raise outcome.error
        return made

    @property
    def _kind(self) -> str:
        return next(name for name in COMMANDS if getattr(self, name))

    def _made(self, num_joints: int, path: str) -> Any:
        """Makes the message, not checked."""
        with self._naming(path):
            plain = getattr(self, self._kind)
            return message_from(COMMANDS[self._kind], plain, num_joints=num_joints)

    @contextmanager
    def _naming(self, path: str) -> Iterator[None]:
        """Names the place of a fault in the scenario."""
        try:
            yield
        except InvalidMessageError as error:
            where = joined(path, f"{self._kind}.{error.field}")
            raise ScenarioError(where, error.value, error.problem) from None


def _take_params(
    message: AtlasSimInterfaceCommand, catalog: BehaviorCatalog, path: str
) -> None:
    """Makes the parameters of a user's own behavior from their fields."""
    entry = catalog.entry(catalog.find(message.behavior))
    reads_params = entry.params is not None and entry.params_field == "params"
    if reads_params and isinstance(message.params, Mapping):
        message.params = checked(entry.params, message.params, path)
