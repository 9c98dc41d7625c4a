"""The events of a run, from what the systems of a station keep of their latest ones.

Each system keeps a bounded list and counts all; ``Marks`` are these counts at an
instant, so that events between two instants are found without reading every tick.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

from atlas_drake.frozen import NOTHING
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import Event, items_since
from atlas_drake.systems.push_source import PushState

_NEVER = -1.0
_T = TypeVar("_T")


class Marks(NamedTuple):
    """What has happened until an instant; the defaults are those of a run's start."""

    controller: float = 0.0  # Number of the controller's events
    messages: float = 0.0  # Number of messages received
    pushes: float = 0.0  # Number of pushes begun
    fall: float = _NEVER  # Time of the fall [s]
    release: float = _NEVER  # Time at which the gantry let the robot down [s]


def marks_at(
    time: float,
    event_count: float,
    commands: ActiveCommand,
    pushes: PushState,
    fall: Any,
    released: float | None,
) -> Marks:
    """Returns the marks of an instant.

    ``event_count`` is the controller's; ``fall`` may be NOTHING. A gantry lets the
    robot down at ``released`` [s].
    """
    return Marks(
        event_count,
        commands.received,
        pushes.begun,
        _NEVER if fall is NOTHING else fall.time,
        _NEVER if released is None or released > time else released,
    )


def events_between(
    before: Marks,
    after: Marks,
    status: ControllerStatus,
    commands: ActiveCommand,
    pushes: PushState,
    fall: Any,
) -> tuple[Event, ...]:
    """Returns the events between two marks, in order of time.

    The values are those at the second instant; the status may be of a later one.
    """
    messages = before.messages, after.messages
    events = [*_between(commands.events, commands.received, *messages)]
    # A controller may start its count again at a reset.
    seen = before.controller if after.controller >= before.controller else 0
    events += _between(status.events, status.event_count, seen, after.controller)
    begun = _between(pushes.recent, pushes.begun, before.pushes, after.pushes)
    events += [push.event() for push in begun]
    if after.fall not in (_NEVER, before.fall) and fall is not NOTHING:
        events.append(Event(fall.time, "fall", f"falling ({fall.sign})"))
    if after.release not in (_NEVER, before.release):
        events.append(Event(after.release, "gantry", "gantry lets the robot down"))
    return tuple(sorted(events, key=lambda event: event.time))


def _between(
    items: tuple[_T, ...], total: int, seen: float, until: float
) -> tuple[_T, ...]:
    """Returns the items after the first ``seen`` ones up to number ``until``."""
    latest = items_since(items, total, int(seen))
    return latest[: max(len(latest) - int(total - until), 0)]
