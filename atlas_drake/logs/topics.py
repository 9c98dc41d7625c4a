"""The topics of a log: which part of a record each holds, and in which form.

Numbers of a group are one message by field and label; what has a structure of its own,
such as footsteps, is one message with the value. ``mcap_writer`` and ``mcap_reader``
use this one table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Message,
    ToeOff,
)
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import Footstep, StepAction
from atlas_drake.records.plain import message_from
from atlas_drake.records.tick_record import ContactForce

TIME, EVENTS = "time", "events"
COMMANDS: dict[str, type[Message]] = {
    "atlas_command": AtlasCommand,
    "atlas_sim_interface_command": AtlasSimInterfaceCommand,
}
"""Topics of the messages that were received."""
ON_CHANGE = frozenset({"gains", "behavior", "hands"})
"""Groups of numbers that are written only when they change."""


@dataclass(frozen=True)
class Structured:
    """A part of a record with a structure of its own, written when it changes.

    Attributes:
        blank: Value before the first message.
        read: Makes the value from its plain form.
        is_message: True for a message, whose fields are those of the topic; any other
            value is in a field that has the name of the topic.
        sample: Value whose structure the schema describes, where that of ``blank`` says
            too little.
    """

    blank: Any
    read: Callable[[Any], Any]
    is_message: bool = False
    sample: Any = None

    def wrapped(self, name: str, value: Any) -> Any:
        """Returns the message of the topic ``name`` for a value."""
        return value if self.is_message else {name: value}

    def content(self, name: str, plain: Any) -> Any:
        """Returns the plain value in a message of the topic ``name``."""
        return plain if self.is_message else plain[name]

    def unwrapped(self, name: str, plain: Any) -> Any:
        """Returns the value of a message in its plain form."""
        return self.read(self.content(name, plain))


def _feedback(kind: type[Message]) -> Structured:
    def read(plain: Any) -> Message:
        return message_from(kind, plain)

    return Structured(kind(), read, is_message=True)


def _footsteps(plain: Any) -> tuple[Footstep, ...]:
    return tuple(map(_footstep, plain))


def _footstep(plain: Mapping[str, Any]) -> Footstep:
    action = {**plain["action"], "toe_off": ToeOff(plain["action"]["toe_off"])}
    parts = {"normal": np.array(plain["normal"]), "action": StepAction(**action)}
    return Footstep(**{**plain, **parts})


def _paths(plain: Any) -> PlannedPaths | None:
    return None if plain is None else PlannedPaths(**plain)


def _contacts(plain: Any) -> tuple[ContactForce, ...] | None:
    if plain is None:
        return None
    return tuple(
        ContactForce(np.array(one["p_WC"]), np.array(one["force_W"])) for one in plain
    )


def _pushes(plain: Any) -> tuple[tuple[str, tuple[float, ...]], ...]:
    return tuple((body, tuple(force_W)) for body, force_W in plain)


_POINT = np.zeros(3)
_LINE = np.zeros((1, 2))
_SAMPLE_PATHS = PlannedPaths(_LINE, _LINE, _LINE, np.zeros((1, 3)))

STRUCTURED: dict[str, Structured] = {
    "stand": _feedback(AtlasBehaviorStandFeedback),
    "walk": _feedback(AtlasBehaviorWalkFeedback),
    "step": _feedback(AtlasBehaviorStepFeedback),
    "manipulate": _feedback(AtlasBehaviorManipulateFeedback),
    "feedback": Structured(None, lambda plain: plain, sample={}),
    "plan": Structured({}, lambda plain: plain),
    "footsteps": Structured((), _footsteps, sample=[Footstep(1, 0, np.zeros(3), 0.0)]),
    "pushes": Structured((), _pushes, sample=[None]),
    "paths": Structured(None, _paths, sample=_SAMPLE_PATHS),
    "contacts": Structured(None, _contacts, sample=[ContactForce(_POINT, _POINT)]),
}
"""Structured parts of a record, by field and topic."""
