"""Events of a run, with time, kind, text and data, and bounded lists of the latest.

Controllers put events into their status; logs, summaries and listeners read them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from atlas_drake.config import as_float
from atlas_drake.errors import shown
from atlas_drake.messages.base import Message
from atlas_drake.messages.checks import check_type

STEPS_LEFT = "steps left"
"""Kind of the event for requested steps that were not taken."""
MESSAGE = "message"
"""Kind of the event for a message that was accepted; its data has the message and its
number. Records and logs hold it; ``sim.events`` does not."""
REFUSAL = "refusal"
"""Kind of the event for a message that was refused; its data has its number, the kind
of command, and the field at fault."""
PUSH = "push"
"""Kind of the event for a push that began; its data has the fields body, force_W and
duration of a scenario's push."""
FOOTSTEP = "footstep"
"""Kind of the event for a foot that landed."""
CONTACT = "contact"
"""Kind of the event for a foot that touches the ground early or late, or stands on a
part of its sole; its data has the step's index and foot, and the time by which it is
early [s], or the share of the sole's area that carries."""
FOOTSTEP_DATA = (
    "foot",
    "commanded",
    "saturated",
    "landed",
    "landed_height",
    "error_m",
    "error_rad",
)
"""Data that each such event has, for displays, figures and summary.

It is 0 or 1 for the left or right foot; x, y [m] and yaw [rad] of the sole as
commanded, as saturated and as landed; the landed height [m]; the landing error in
position [m] and in heading [rad].
"""
READ_WITHIN = 0.1
"""Longest time between two reads of any reader of recent items [s]: several times the
longest control period, and several chunks of a simulation."""


@dataclass(frozen=True)
class Event:
    """An event for the user: printed, logged, and written to the summary.

    Attributes:
        time: Time of the event [s].
        kind: One word or two, such as ``fall``, ``footstep``, ``warning``.
        text: Text for people.
        data: Values for programs: plain numbers, text, lists. The data of a
            ``FOOTSTEP`` has the keys ``FOOTSTEP_DATA``.
    """

    time: float
    kind: str
    text: str
    data: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check what everybody relies on."""
        time = as_float(self.time)
        if time is None or not math.isfinite(time):
            raise TypeError(f"time must be a finite number, is {shown(self.time)}")
        for name, kind in (("kind", str), ("text", str), ("data", Mapping)):
            check_type(getattr(self, name), kind, name)
        if self.kind == FOOTSTEP and (lacking := {*FOOTSTEP_DATA} - self.data.keys()):
            raise ValueError(f"data of an Event {FOOTSTEP!r} lacks {sorted(lacking)}")

    def __str__(self) -> str:
        """Return time and text."""
        return f"{self.time:.3f} s: {self.text}"


@dataclass(frozen=True)
class RunEvent(Event):
    """An event outside the station, such as a reset, which is in no record."""


@dataclass(frozen=True)
class LoggedCommand:
    """An accepted command, and the time of its receipt [s]."""

    time: float
    message: Message

    @classmethod
    def of(cls, event: Event) -> LoggedCommand:
        """Return the command of an event of kind ``MESSAGE``."""
        return cls(event.time, event.data["message"])


def fell_last(events: Iterable[Event]) -> bool:
    """Return True if the robot fell since its last reset."""
    kinds = [event.kind for event in events if event.kind in ("fall", "reset")]
    return kinds[-1:] == ["fall"]


def first_falls(events: Iterable[Event], fallen: bool = False) -> list[Event]:
    """Return the events with the first one of each fall only.

    Both the controller and the fall monitor report a fall; ``fallen`` is True if the
    robot has fallen already.
    """
    kept = []
    for event in events:
        if event.kind == "fall" and fallen:
            continue
        if event.kind in ("fall", "reset"):
            fallen = event.kind == "fall"
        kept.append(event)
    return kept


_T = TypeVar("_T")


def append_recent(items: tuple[Any, ...], item: Any, kept: int) -> tuple[Any, ...]:
    """Append an item with a time; drop the oldest beyond ``kept``, not READ_WITHIN."""
    drop = 0
    while len(items) - drop >= kept and items[drop].time < item.time - READ_WITHIN:
        drop += 1
    return (*items[drop:], item)


def items_since(items: tuple[_T, ...], total: int, seen: int) -> tuple[_T, ...]:
    """Return those of the latest items that came after the first ``seen`` of all."""
    count = total - seen
    return items[-count:] if count > 0 else ()
