"""Records a run to a log: an extension and a listener of a simulation."""

from __future__ import annotations

import weakref
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydrake.systems.framework import DiagramBuilder

from atlas_drake.clients.logs.header import LogError
from atlas_drake.clients.logs.mcap_writer import McapWriter, header_of
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.messages.event import Event, RunEvent
from atlas_drake.scenario.scenario import LogContent
from atlas_drake.simulation.sockets import RecordListener, add_listener


class LogRecording:
    """Writes the log of a simulation's first run; later runs are not recorded.

    Attributes:
        is_open: True until the log is completed.
    """

    def __init__(self, path: Path, keep: LogContent) -> None:
        """Checks that the file can be written; raises LogError if it cannot.

        Args:
            path: Of the file, ``NAME.mcap``.
            keep: What the log holds beside the numbers of every tick.
        """
        self._writer, self._keep = McapWriter(path), keep
        self.is_open = True

    @property
    def fault(self) -> LogError | None:
        """Error that ended the writing; None if there was none."""
        return self._writer.fault

    def extend(self, builder: DiagramBuilder, station: Any) -> None:
        """Adds a listener to a diagram with an AtlasStation; it writes each record."""
        self._source: RecordListener = add_listener(
            builder,
            station,
            "log",
            self._writer.record,
            paths=self._keep.paths,
            contacts=self._keep.contacts,
        )

    def begin(self, sim: Any) -> None:
        """Begins the log of the run that begins."""
        if not self.is_open:
            return
        shipped = {one.name for one in SHIPPED}
        own = [one for one in sim.behaviors if one.name not in shipped]
        header = header_of(sim.scenario, sim.robot, own)
        self._writer.begin(header, sim.schema)
        self._sim = weakref.ref(sim)
        # Without ``close`` the file is completed when the simulation is freed or the
        # program ends.
        self._complete = weakref.finalize(sim, self._writer.close)

    def event(self, event: Event) -> None:
        """Writes an event of the run; the records hold all others."""
        if isinstance(event, RunEvent):
            self._writer.event(event)

    def close(self) -> None:
        """Completes the log, with the latest record and the events after it.

        Raises:
            LogError: If it cannot be written, now or earlier.
        """
        sim = self._sim()
        if not self.is_open or sim is None:
            return
        self.is_open = False
        # What prevents a record has ended the run already, with its error.
        with suppress(Exception):
            source, context = self._source, sim.context
            source.flush(source.GetMyContextFromRoot(context))
            recorder = sim.station.GetSubsystemByName("tick_recorder")
            of_recorder = recorder.GetMyMutableContextFromRoot(context)
            for event in recorder.events_after_tick(of_recorder):
                self._writer.event(event)
        self._complete()
