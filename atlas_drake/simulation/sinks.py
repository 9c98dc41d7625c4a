"""Sinks of an ``AtlasSimulation``: logs, and listeners to its events."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pydrake.systems.framework import Context

from atlas_drake.errors import AtlasError
from atlas_drake.messages.event import Event, RunEvent

if TYPE_CHECKING:
    from atlas_drake.logs.mcap_writer import McapWriter
    from atlas_drake.systems.record_reader import RecordListener
    from atlas_drake.systems.tick_recorder import TickRecorder


class Sink(Protocol):
    """What ``AtlasSimulation.attach`` takes."""

    @property
    def path(self) -> Path | None:
        """File that holds one run, so that no new run begins before ``detach``.

        None for a sink that takes any number of runs.
        """

    @property
    def fault(self) -> AtlasError | None:
        """Error that ended the recording, None without one.

        The run continues and has a warning among its events.
        """

    def event(self, event: Event) -> None:
        """Takes each event as it is noticed."""

    def close(self, root: Context) -> Any:
        """Completes the sink, with what the diagram's context holds.

        The result is that of ``detach``.
        """


class Listener:
    """Passes events to a callable."""

    path = None
    fault = None

    def __init__(self, on_event: Callable[[Event], None]) -> None:
        """Calls ``on_event`` with each event."""
        self.event = on_event

    def close(self, root: Context) -> None:
        """Does nothing: a callable has no end."""


class LogSink:
    """A log of a run, fed by a listener in the diagram.

    Without ``close`` the file is completed when the simulation is freed or the program
    ends.
    """

    def __init__(
        self, writer: McapWriter, listener: RecordListener, recorder: TickRecorder
    ) -> None:
        """Takes over ``writer``, which ``listener`` hands records to."""
        self.path = writer.path
        self._writer, self._listener, self._recorder = writer, listener, recorder
        self._complete = weakref.finalize(self, writer.close)

    @property
    def fault(self) -> AtlasError | None:
        """Error that ended the writing."""
        return self._writer.fault

    def event(self, event: Event) -> None:
        """Passes an event on that no record holds."""
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
