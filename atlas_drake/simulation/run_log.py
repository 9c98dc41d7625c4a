"""The events of a run, its log file, and its snapshots.

Events are read from the station from time to time; ``summary`` evaluates them.
"""

from __future__ import annotations

import copy
import weakref
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

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
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.tick_events import NO_MARKS

if TYPE_CHECKING:
    from atlas_drake.logs.mcap_writer import McapWriter
    from atlas_drake.systems.record_reader import RecordListener
    from atlas_drake.systems.tick_recorder import TickRecorder


class LogFile:
    """The log of a run, which a listener in the diagram hands records to.

    Without ``close`` the file is completed when the simulation is freed or the program
    ends.
    """

    def __init__(
        self, writer: McapWriter, listener: RecordListener, recorder: TickRecorder
    ) -> None:
        """Takes over ``writer``, which ``listener`` hands records to."""
        self._writer, self._listener, self._recorder = writer, listener, recorder
        self._complete = weakref.finalize(self, writer.close)

    @property
    def fault(self) -> AtlasError | None:
        """Error that ended the writing, None without one; the run continues."""
        return self._writer.fault

    def event(self, event: Event) -> None:
        """Writes an event, unless the records hold it."""
        if isinstance(event, RunEvent):
            self._writer.event(event)

    def close(self, root: Context) -> None:
        """Completes the file, with the latest record and the events after it.

        Raises:
            LogError: If the log cannot be written, now or earlier in the run.
        """
        # What prevents a record has ended the run already, with its error.
        with suppress(Exception):
            self._listener.flush(self._listener.GetMyContextFromRoot(root))
            context = self._recorder.GetMyContextFromRoot(root)
            for event in self._recorder.events_after_tick(context):
                self._writer.event(event)
        self._complete()


class RunLog:
    """The events of one run, in order of time within each read.

    Attributes:
        events: All events but the messages that were received.
        footsteps: Data of the events of landed feet.
        file: Takes the events that no record holds; None without a log.
    """

    def __init__(
        self, schedule: Sequence[ScheduledCommand] = (), file: LogFile | None = None
    ):
        """Starts without events; ``schedule`` are the commands that are sent."""
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self.file = file
        self._schedule, self._sent = schedule, 0
        self._marks: Sequence[float] = NO_MARKS
        self._fault: AtlasError | None = None

    def copy(self) -> RunLog:
        """Returns a log that goes on by itself."""
        log = copy.copy(self)
        log.events, log.footsteps = list(self.events), list(self.footsteps)
        return log

    def look(self, run: RunDiagram) -> list[Event]:
        """Adds and returns all events since the last look."""
        sent = run.output("sent") if self._schedule else 0
        fresh: list[Event] = [
            RunEvent(entry.time, "command", entry.text)
            for entry in self._schedule[self._sent : sent]
        ]
        self._sent = sent
        events, self._marks = run.events_since(self._marks)
        fresh += (event for event in events if event.kind != MESSAGE)
        fresh.sort(key=lambda event: event.time)
        fault = self.file.fault if self.file is not None else None
        if fault is not None and self._fault is None:
            self._fault = fault
            text = f"{fault}; the run continues without it"
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
        if self.file is not None:
            for event in kept:
                self.file.event(event)
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
