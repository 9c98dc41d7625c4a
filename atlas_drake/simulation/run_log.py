"""What happened in a run, read off the diagram's ports from time to time.

It only listens. What a summary makes of it is in ``summary``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from atlas_drake.frozen import replace
from atlas_drake.messages.commands import CommandsInForce
from atlas_drake.messages.controller_status import ControllerStatus, check_status
from atlas_drake.messages.event import FOOTSTEP, Event
from atlas_drake.messages.recent import items_since
from atlas_drake.systems.command_scheduler import ScheduledCommand

LONG_UNSOLVED = 5
"""Number of control ticks without a solution, between two looks, that is news: one or
two in a hard moment are what the fallback is for."""


class RunLog:
    """The events of one run, in order of time within each look.

    Attributes:
        events: All of them.
        footsteps: The data of those that are about a landed foot.
    """

    def __init__(self, *listeners: Callable[[Event], None] | None):
        """Calls the listeners, as far as there are any, with each event."""
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self._listeners = [heard for heard in listeners if heard is not None]
        self._seen_events = 0
        self._seen_sent = 0
        self._seen_refusals = 0
        self._seen_unsolved = 0
        self._told_unsolved = False

    def collect(
        self,
        programme: tuple[ScheduledCommand, ...],
        sent: int,
        commands: CommandsInForce,
        status: ControllerStatus,
        *,
        anew: bool = False,
    ) -> None:
        """Notes what was sent, refused and done since the last look.

        Args:
            programme: All of it.
            sent: How many of its commands were sent.
            commands: In force.
            status: Of the controller.
            anew: Whether the controller was reset since then, and so may have begun to
                count its events anew.

        Raises:
            TypeError: If the status is none.
            ValueError: If it names a behavior that is not registered, or counts back.
        """
        check_status(status, commands.catalog)
        seen, self._seen_events = self._seen_events, status.event_count
        if status.event_count < seen:
            if not anew:
                raise ValueError(
                    "event_count in the controller's status went back from "
                    f"{seen} to {status.event_count}: it must count all events of the "
                    "run, those that were dropped among them; only a reset may begin "
                    "anew"
                )
            seen = 0
        fresh = [
            Event(entry.time, "command", entry.text)
            for entry in programme[self._seen_sent : sent]
        ]
        self._seen_sent = sent
        fresh.extend(
            Event(refusal.time, "refusal", refusal.text)
            for refusal in commands.refusals_since(self._seen_refusals)
        )
        self._seen_refusals = commands.refused
        fresh.extend(items_since(status.events, status.event_count, seen))
        self.note(*sorted(fresh, key=lambda event: event.time))

    def watch_solver(self, time: float, status: ControllerStatus) -> None:
        """Tells once of a controller that finds no solution for many ticks.

        Args:
            time: Now [s].
            status: Of the controller.
        """
        unsolved = status.unsolved
        many = unsolved - self._seen_unsolved >= LONG_UNSOLVED
        self._seen_unsolved = unsolved
        if many and status.solved is False and not self._told_unsolved:
            self._told_unsolved = True
            text = (
                f"the controller has found no solution in {unsolved} control ticks so "
                "far; a fallback holds the robot, badly"
            )
            if status.why_unsolved:
                text += f" ({status.why_unsolved})"
            self.note(Event(time, "warning", text))

    def note(self, *events: Event) -> None:
        """Adds events, and then tells the listeners: what one raises loses none."""
        # A robot that has fallen falls no further, whoever notices it second.
        fallen = self.fallen()
        kept = [e for e in events if not (fallen and e.kind == "fall")]
        for event in kept:
            self.events.append(replace(event, time=round(event.time, 6)))
            if event.kind == FOOTSTEP:
                self.footsteps.append(event.data)
        for heard in self._listeners:
            for event in kept:
                heard(event)

    def fallen(self) -> bool:
        """Whether the robot fell since it was last reset."""
        for event in reversed(self.events):
            if event.kind in ("fall", "reset"):
                return event.kind == "fall"
        return False
