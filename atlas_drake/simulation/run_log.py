"""The events of a run, and its snapshots.

Events are read from the station from time to time; ``summary`` evaluates them.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydrake.systems.framework import Context

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
from atlas_drake.scenario import Scenario
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.start import Variation
from atlas_drake.systems.tick_events import NO_MARKS


class RunLog:
    """The events of one run but the messages received, in order within each read."""

    def __init__(self, run: RunDiagram):
        """Starts without events."""
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self._run, self._sent = run, 0
        self._marks: Sequence[float] = NO_MARKS
        self._fault: AtlasError | None = None

    def copy(self) -> RunLog:
        """Returns a log that goes on by itself."""
        log = copy.copy(self)
        log.events, log.footsteps = list(self.events), list(self.footsteps)
        return log

    def look(self) -> list[Event]:
        """Adds and returns all events since the last look."""
        run = self._run
        sent = run.output("sent") if run.schedule else 0
        fresh: list[Event] = [
            RunEvent(entry.time, "command", entry.text)
            for entry in run.schedule[self._sent : sent]
        ]
        self._sent = sent
        recorder, context = run.part("tick_recorder")
        events, self._marks = recorder.events_since(context, self._marks)
        fresh += (event for event in events if event.kind != MESSAGE)
        fresh.sort(key=lambda event: event.time)
        if run.writer is not None and run.writer.fault is not self._fault:
            self._fault = run.writer.fault
            text = f"{self._fault}; the run continues without it"
            fresh.append(RunEvent(run.context.get_time(), "warning", text))
        return self.note(*fresh)

    def note(self, *events: Event) -> list[Event]:
        """Adds events, and returns those that were kept."""
        kept = [
            replace(event, time=round(event.time, 6))
            for event in first_falls(events, self.fallen())
        ]
        self.events += kept
        self.footsteps += (event.data for event in kept if event.kind == FOOTSTEP)
        for event in kept:
            # The records hold all others.
            if self._run.writer is not None and isinstance(event, RunEvent):
                self._run.writer.event(event)
        return kept

    def fallen(self) -> bool:
        """Returns True if the robot fell since its last reset."""
        return fell_last(self.events)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Everything that decides how a run goes on; valid as long as its simulation.

    Attributes:
        context: Copy of the diagram's root context: physics, joint controllers,
            behaviors, commands in force and received, schedule, pushes, noise.
        scenario: The scenario of the run.
        variation: What the run drew from its seed.
        log: Copy of the events until then.
        wall_time: Wall time of the run until then [s].
    """

    context: Context
    scenario: Scenario
    variation: Variation
    log: RunLog
    wall_time: float

    @property
    def time(self) -> float:
        """Simulated time of the snapshot [s]."""
        return float(self.context.get_time())
