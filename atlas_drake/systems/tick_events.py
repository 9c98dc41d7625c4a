"""The events of a run, from what the systems of a station keep of their latest ones.

Each system keeps a bounded list and counts all; ``marks`` are these counts at an
instant, so that events between two instants are found without reading every tick.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from atlas_drake.frozen import NOTHING
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import Event, items_since
from atlas_drake.systems.push_source import PushState

_NEVER = -1.0
NO_MARKS = (0.0, 0.0, 0.0, _NEVER, _NEVER)
"""Marks at the start of a run."""
NUM_MARKS = len(NO_MARKS)
_T = TypeVar("_T")


def marks_at(
    time: float,
    event_count: float,
    commands: ActiveCommand,
    pushes: PushState,
    fall: Any,
    released: float | None,
) -> list[float]:
    """Returns the marks of an instant, ``NUM_MARKS`` numbers.

    ``event_count`` is the controller's; ``fall`` may be NOTHING. A gantry lets the
    robot down at ``released`` [s].
    """
    return [
        event_count,
        commands.received,
        pushes.begun,
        _NEVER if fall is NOTHING else fall.time,
        _NEVER if released is None or released > time else released,
    ]


def events_between(
    before: Sequence[float],
    after: Sequence[float],
    status: ControllerStatus,
    commands: ActiveCommand,
    pushes: PushState,
    fall: Any,
) -> tuple[Event, ...]:
    """Returns the events between two marks, in order of time.

    The values are those at the second instant; the status may be of a later one.
    """
    events = [*_between(commands.events, commands.received, before[1], after[1])]
    # A controller may start its count again at a reset.
    seen = before[0] if after[0] >= before[0] else 0
    events += _between(status.events, status.event_count, seen, after[0])
    events += (
        push.event()
        for push in _between(pushes.recent, pushes.begun, before[2], after[2])
    )
    if after[3] not in (_NEVER, before[3]) and fall is not NOTHING:
        events.append(Event(fall.time, "fall", f"falling ({fall.sign})"))
    if after[4] not in (_NEVER, before[4]):
        events.append(Event(after[4], "gantry", "gantry lets the robot down"))
    return tuple(sorted(events, key=lambda event: event.time))


def _between(
    items: tuple[_T, ...], total: int, seen: float, until: float
) -> tuple[_T, ...]:
    """Returns the items after the first ``seen`` ones up to number ``until``."""
    latest = items_since(items, total, int(seen))
    return latest[: max(len(latest) - int(total - until), 0)]
