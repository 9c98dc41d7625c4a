"""The events of a run, what was done in it, and its snapshots.

Events are read from the station from time to time; ``summary`` evaluates them, and
``done`` makes a scenario of what was done.
"""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pydrake.systems.framework import Context

from atlas_drake.errors import ScenarioError
from atlas_drake.frozen import replace
from atlas_drake.messages.event import (
    FOOTSTEP,
    MESSAGE,
    PUSH,
    Event,
    LoggedCommand,
    RunEvent,
    fell_last,
    first_falls,
)
from atlas_drake.scenario import Scenario
from atlas_drake.simulation.beginning import Variation
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.tick_events import Marks

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

KEPT = 20_000
"""Number of messages and pushes that are kept: an hour of a walk by hand, and at most
200 MB."""


@dataclass(frozen=True, eq=False)
class Beginning:
    """How the robot began, at the start of the run or at its last reset.

    Attributes:
        time: When it began [s].
        scenario: The scenario of a run that begins so.
    """

    time: float
    scenario: Scenario


@dataclass(frozen=True)
class Done:
    """A message that was accepted, or a push that began.

    Attributes:
        event: Its event, of kind ``MESSAGE`` or ``PUSH``.
        is_published: True for a message from outside the diagram. At the instant of a
            control tick, that tick hears it already, unlike a message on a port.
    """

    event: Event
    is_published: bool


class RunLog:
    """The events of one run, in order within each read, and apart what was done.

    Messages that were accepted are not among the events.

    Attributes:
        beginning: How the robot began.
    """

    def __init__(self, scenario: Scenario, schedule: Sequence[ScheduledCommand]):
        """Starts without events; ``schedule`` has those of a scheduler."""
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self.beginning = Beginning(0.0, scenario)
        self._done: deque[Done] = deque(maxlen=KEPT)
        self._done_since = 0  # Number of those since the beginning.
        self._published: frozenset[int] = frozenset()  # Messages since the last look.
        self._schedule, self._sent = schedule, 0
        self._marks = Marks()

    def copy(self) -> RunLog:
        """Returns a log that goes on by itself."""
        log = copy.copy(self)
        log.events, log.footsteps = list(self.events), list(self.footsteps)
        log._done = self._done.copy()
        return log

    @property
    def commands(self) -> list[LoggedCommand]:
        """The accepted commands of the run, in order; the last ``KEPT`` at most."""
        events = (one.event for one in self._done)
        return [LoggedCommand.of(event) for event in events if event.kind == MESSAGE]

    def done(self) -> list[Done]:
        """Returns what was done since the beginning, in order.

        Raises:
            ScenarioError: If it is more than ``KEPT``.
        """
        count = self._done_since
        if count > KEPT:
            problem = f"are more than {KEPT} since the last reset; the last are kept"
            raise ScenarioError("messages", count, problem)
        return list(self._done)[len(self._done) - count :]

    def begin(self, beginning: Beginning) -> None:
        """Notes that the robot begins anew."""
        self.beginning, self._done_since = beginning, 0

    def published(self, number: int) -> None:
        """Notes that a message came from outside the diagram.

        Args:
            number: Its number among all received.
        """
        self._published |= {number}

    def look(self, sim: AtlasSimulation) -> list[Event]:
        """Adds and returns all events since the last look."""
        sent = sim.output("sent") if self._schedule else 0
        fresh: list[Event] = [
            RunEvent(entry.time, "command", entry.text)
            for entry in self._schedule[self._sent : sent]
        ]
        self._sent = sent
        recorder, context = sim.part("tick_recorder")
        events, self._marks = recorder.events_since(context, self._marks)
        self._note_done(events)
        fresh += (event for event in events if event.kind != MESSAGE)
        fresh.sort(key=lambda event: event.time)
        return self.note(*fresh)

    def drop_schedule(self, time: float) -> list[Event]:
        """Counts the schedule as told, and notes that the rest is dropped."""
        left = len(self._schedule) - self._sent
        self._sent += left
        text = f"the rest of the schedule is dropped, {left} commands"
        event = RunEvent(time, "schedule", text)
        return self.note(event) if left else []

    def _note_done(self, events: Sequence[Event]) -> None:
        for event in events:
            if event.kind in (MESSAGE, PUSH):
                published = event.data.get("number") in self._published
                self._done.append(Done(event, published))
                self._done_since += 1
        self._published = frozenset()

    def note(self, *events: Event) -> list[Event]:
        """Adds events, and returns those that were kept."""
        kept = [
            replace(event, time=round(event.time, 6))
            for event in first_falls(events, self.fallen())
        ]
        self.events += kept
        self.footsteps += (event.data for event in kept if event.kind == FOOTSTEP)
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
