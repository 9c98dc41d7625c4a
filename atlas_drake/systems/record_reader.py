"""How systems read records: their input ports, and a system that hands records on."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.geometry import QueryObject
from pydrake.multibody.plant import ContactResults
from pydrake.systems.framework import Context, DiagramBuilder, LeafSystem, System

from atlas_drake.frozen import NOTHING, replace
from atlas_drake.records import TickRecord
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.contact_forces import contact_forces

PATHS_PERIOD = 0.1
"""Time between two readings of the planned paths for a log, which change slowly [s]."""


class RecordInputs:
    """The input ports of a system that reads records.

    Input ports:
        record: ``TickRecord``
        planned_paths: ``PlannedPaths``; left out in a replay.
        contact_results: Contact results of the plant; left out in a replay.
        query_object: Of the scene graph.
    """

    def __init__(self, system: LeafSystem) -> None:
        """Declares the ports of ``system``."""
        self._system = system
        for name, blank in (
            ("record", NOTHING),
            ("planned_paths", NOTHING),
            ("contact_results", ContactResults()),
            ("query_object", QueryObject()),
        ):
            system.DeclareAbstractInputPort(name, AbstractValue.Make(blank))

    def connect(self, builder: DiagramBuilder, station: System) -> None:
        """Connects the ports to those of a station, or of a replay."""
        for index in range(self._system.num_input_ports()):
            port = self._system.get_input_port(index)
            if station.HasOutputPort(port.get_name()):
                builder.Connect(station.GetOutputPort(port.get_name()), port)

    def record(self, context: Context) -> TickRecord:
        """Returns the record of the latest control tick."""
        record: TickRecord = self._eval("record", context)
        return record

    def with_paths(self, record: TickRecord, context: Context) -> TickRecord:
        """Returns the record with the planned paths of the present."""
        if not self._has("planned_paths", context):
            return record
        return replace(record, paths=self._eval("planned_paths", context))

    def with_contacts(self, record: TickRecord, context: Context) -> TickRecord:
        """Returns the record with the contact forces of the present."""
        if not self._has("contact_results", context):
            return record
        results = self._eval("contact_results", context)
        return replace(
            record, contacts=contact_forces(results, self.inspector(context))
        )

    def inspector(self, context: Context) -> Any:
        """Returns the inspector of the scene graph."""
        return self._eval("query_object", context).inspector()

    def _has(self, name: str, context: Context) -> bool:
        return self._system.GetInputPort(name).HasValue(context)

    def _eval(self, name: str, context: Context) -> Any:
        return self._system.GetInputPort(name).Eval(context)


class RecordListener(CollectableSystem):
    """Calls a function with the record of every control tick.

    A record is handed on one tick later, by a publish event. This object remembers the
    last one, and no Context does, because the memory belongs to the listener. Input
    ports are those of ``RecordInputs``.
    """

    __slots__ = ()

    def __init__(
        self,
        listen: Callable[[TickRecord], object],
        period: float,
        *,
        paths: bool = False,
        contacts: bool = False,
    ) -> None:
        """Listens every ``period`` [s], at choice with planned paths and contacts."""
        super().__init__()
        self._listen, self._paths, self._contacts = listen, paths, contacts
        self.inputs = RecordInputs(self)
        self._last_time = self._paths_time = -math.inf
        self._planner = -1
        self.DeclarePeriodicPublishEvent(period, 0.0, self.flush)

    def flush(self, context: Context) -> None:
        """Hands on the latest record, unless it was handed on already."""
        now = context.get_time()
        if now == 0.0:  # There is no record before the first tick.
            return
        record = self.inputs.record(context)
        # Before the first tick after a reset a record describes the present.
        if record.time == self._last_time or record.time > now - 1e-9:
            return
        self._last_time = record.time
        if self._paths and self._paths_are_due(record):
            record = self.inputs.with_paths(record, context)
        if self._contacts:
            record = self.inputs.with_contacts(record, context)
        self._listen(record)

    def _paths_are_due(self, record: TickRecord) -> bool:
        passed = record.time - self._paths_time
        if 0.0 <= passed < PATHS_PERIOD - 1e-9 and (
            record.behavior.current == self._planner
        ):
            return False
        self._paths_time, self._planner = record.time, record.behavior.current
        return True


def add_listener(
    builder: DiagramBuilder,
    station: Any,
    name: str,
    listen: Callable[[TickRecord], object],
    *,
    paths: bool = False,
    contacts: bool = False,
) -> RecordListener:
    """Adds a listener to a diagram with an AtlasStation; arguments as for the class."""
    period = station.GetSubsystemByName("tick_recorder").period
    listener = RecordListener(listen, period, paths=paths, contacts=contacts)
    builder.AddNamedSystem(name, listener)
    listener.inputs.connect(builder, station)
    return listener
