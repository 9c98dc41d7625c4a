"""Sinks of an ``AtlasSimulation``: logs, videos, and listeners to its events."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pydrake.systems.framework import Context

from atlas_drake.errors import AtlasError
from atlas_drake.messages.event import Event

if TYPE_CHECKING:
    from atlas_drake.logs.recorder import LogRecorder
    from atlas_drake.visualization.video_display import VideoDisplay


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


class FileSink:
    """A file that a system of the diagram writes.

    Without ``close`` the file is completed when the simulation is freed or the program
    ends.
    """

    def __init__(self, path: Path, writer: LogRecorder | VideoDisplay) -> None:
        """Takes over ``writer``, which writes ``path``."""
        self.path = path
        self._writer: Any = writer
        self._complete = weakref.finalize(self, writer.close)

    @property
    def fault(self) -> AtlasError | None:
        """Error that ended the writing."""
        return self._writer.fault

    def event(self, event: Event) -> None:
        """Passes an event on to a log; the pictures of a video show their state."""
        if hasattr(self._writer, "event"):
            self._writer.event(event)

    def close(self, root: Context) -> Any:
        """Completes the file.

        Returns:
            The number of pictures of a video; None for a log.

        Raises:
            LogError: If a log cannot be written, now or earlier in the run.
            VideoError: If a video cannot be written, now or earlier in the run.
        """
        try:
            if hasattr(self._writer, "flush"):
                self._writer.flush(self._writer.GetMyContextFromRoot(root))
        finally:
            completed = self._complete()
        return completed
