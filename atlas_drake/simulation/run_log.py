"""The events of a run, read from the diagram's ports from time to time.

The log only reads; ``summary`` evaluates the events.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from typing import Any

from atlas_drake.errors import AtlasError
from atlas_drake.frozen import NOTHING, replace
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import FOOTSTEP, Event
from atlas_drake.messages.recent import items_since
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.sinks import Sink
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.push_source import PushState

LONG_UNSOLVED = 5
"""Least number of control ticks without a solution for a warning, since a read at which
there was one; the fallback handles one or two."""


class RunLog:
    """The events of one run, in order of time within each read.

    Attributes:
        events: All events.
        footsteps: Data of the events of landed feet.
    """

    def __init__(
        self, programme: Sequence[ScheduledCommand] = (), sinks: Iterable[Sink] = ()
    ):
        """Starts without events.

        Args:
            programme: The commands that the scheduler sends.
            sinks: Each event goes to every sink that is in here at that time.
        """
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self._programme, self._sinks = programme, sinks
        self._faults: list[AtlasError] = []
        self._seen_events = 0
        self._seen_sent = 0
        self._seen_refusals = 0
        self._seen_unsolved = 0
        self._seen_pushes = 0
        self._seen_release: float | None = None
        self._told_unsolved = False

    def copy(self) -> RunLog:
        """Returns a log that goes on by itself, with the same sinks."""
        log = copy.copy(self)
        log.events, log.footsteps = list(self.events), list(self.footsteps)
        return log

    def look(self, run: RunDiagram, *, anew: bool = False) -> None:
        """Adds all events since the last look; errors are those of ``collect``."""
        time = run.context.get_time()
        status = run.output("controller_status")
        sent = run.output("sent") if self._programme else 0
        commands, pushes = run.output("commands"), run.output("pushes")
        self.collect(sent, commands, status, pushes, anew=anew)
        released = None
        if run.station.HasSubsystemNamed("harness"):
            released = run.output("harness").released
        self.watch_robot(time, run.output("fall"), released)
        self.watch_solver(time, status)
        for sink in self._sinks:
            fault = sink.fault
            if fault is not None and fault not in self._faults:
                self._faults.append(fault)
                text = f"{fault}; the run continues without it"
                self.note(Event(time, "warning", text))

    def collect(
        self,
        sent: int,
        commands: ActiveCommand,
        status: ControllerStatus,
        pushes: PushState,
        *,
        anew: bool = False,
    ) -> None:
        """Adds the events of commands, refusals and controller since the last read.

        ``sent`` counts the sent commands of the programme. ``anew`` is True if the
        controller was reset since the last read, and so may have started its event
        count again.

        Raises:
            ValueError: If the event count in the status decreased.
        """
        seen, self._seen_events = self._seen_events, status.event_count
        if status.event_count < seen:
            if not anew:
                raise ValueError(
                    "event_count in the controller's status went back from "
                    f"{seen} to {status.event_count}: it must count all events of the "
                    "run, including dropped ones; only a reset may start the count "
                    "again"
                )
            seen = 0
        fresh = [
            Event(entry.time, "command", entry.text)
            for entry in self._programme[self._seen_sent : sent]
        ]
        self._seen_sent = sent
        fresh.extend(
            Event(refusal.time, "refusal", refusal.text)
            for refusal in commands.refusals_since(self._seen_refusals)
        )
        self._seen_refusals = commands.refused
        fresh.extend(items_since(status.events, status.event_count, seen))
        begun, self._seen_pushes = self._seen_pushes, pushes.begun
        fresh.extend(
            Event(push.time, "push", push.text())
            for push in items_since(pushes.recent, pushes.begun, begun)
        )
        self.note(*sorted(fresh, key=lambda event: event.time))

    def watch_robot(self, time: float, fall: Any, released: float | None) -> None:
        """Adds the events of a fall and of the harness since the last read.

        Args:
            time: Present time [s].
            fall: The fall of the robot since the last reset, or NOTHING.
            released: Time at which the harness releases the robot [s]; None if unknown.
        """
        if released is None or released > time:
            self._seen_release = None
        elif released != self._seen_release:
            self._seen_release = released
            self.note(Event(released, "harness", "harness lets the robot down"))
        if fall is not NOTHING and not self.fallen():
            self.note(Event(fall.time, "fall", f"falling ({fall.sign})"))

    def watch_solver(self, time: float, status: ControllerStatus) -> None:
        """Warns once of a controller that finds no solution for many ticks."""
        unsolved = status.unsolved
        if status.solved is not False:
            self._seen_unsolved = unsolved
        many = unsolved - self._seen_unsolved >= LONG_UNSOLVED
        if many and not self._told_unsolved:
            self._told_unsolved = True
            text = (
                f"the controller has found no solution in {unsolved} control ticks so "
                "far; a fallback that does not balance holds the robot"
            )
            if status.why_unsolved:
                text += f" ({status.why_unsolved})"
            self.note(Event(time, "warning", text))

    def note(self, *events: Event) -> None:
        """Adds events, and then calls the listeners, whose errors lose no event."""
        # Keep the first event of a fall only: both controller and fall watch report it.
        fallen = self.fallen()
        kept = [
            replace(event, time=round(event.time, 6))
            for event in events
            if not (fallen and event.kind == "fall")
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
        for event in reversed(self.events):
            if event.kind in ("fall", "reset"):
                return event.kind == "fall"
        return False
