"""The events of a run, read from the station from time to time.

``summary`` evaluates the events.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from typing import Any

from atlas_drake.errors import AtlasError
from atlas_drake.frozen import replace
from atlas_drake.messages.event import (
    FOOTSTEP,
    MESSAGE,
    Event,
    RunEvent,
    fell_last,
    first_falls,
)
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.sinks import Sink
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.tick_events import NO_MARKS


class RunLog:
    """The events of one run, in order of time within each read.

    Attributes:
        events: All events but the messages that were received.
        footsteps: Data of the events of landed feet.
    """

    def __init__(
        self, schedule: Sequence[ScheduledCommand] = (), sinks: Iterable[Sink] = ()
    ):
        """Starts without events.

        Args:
            schedule: The commands that the scheduler sends.
            sinks: Each event goes to every sink that is in here at that time.
        """
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self._schedule, self._sinks = schedule, sinks
        self._faults: list[AtlasError] = []
        self._marks: Sequence[float] = NO_MARKS
        self._sent = 0

    def copy(self) -> RunLog:
        """Returns a log that goes on by itself, with the same sinks."""
        log = copy.copy(self)
        log.events, log.footsteps = list(self.events), list(self.footsteps)
        return log

    def look(self, run: RunDiagram) -> None:
        """Adds all events since the last look."""
        sent = run.output("sent") if self._schedule else 0
        fresh: list[Event] = [
            RunEvent(entry.time, "command", entry.text)
            for entry in self._schedule[self._sent : sent]
        ]
        self._sent = sent
        events, self._marks = run.events_since(self._marks)
        fresh += (event for event in events if event.kind != MESSAGE)
        if fresh:
            self.note(*sorted(fresh, key=lambda event: event.time))
        for sink in self._sinks:
            fault = sink.fault
            if fault is not None and fault not in self._faults:
                self._faults.append(fault)
                text = f"{fault}; the run continues without it"
                self.note(RunEvent(run.context.get_time(), "warning", text))

    def note(self, *events: Event) -> None:
        """Adds events, and then calls the listeners, whose errors lose no event."""
        kept = [
            replace(event, time=round(event.time, 6))
            for event in first_falls(events, self.fallen())
        ]
        for event in kept:
            self.events.append(event)
            if event.kind == FOOTSTEP:
                self.footsteps.append(event.data)
        for sink in tuple(self._sinks):  # A sink may detach itself.
            for event in kept:
                sink.event(event)

    def fallen(self) -> bool:
        """Returns True if the robot fell since its last reset."""
        return fell_last(self.events)
