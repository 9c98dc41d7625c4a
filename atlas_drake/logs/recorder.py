"""Records a station: one row of numbers per control tick, and notes beside it.

``samples`` computes a row; the writer of the log's format writes files.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    Context,
    DiagramBuilder,
    DiscreteValues,
    InputPort,
    System,
)

from atlas_drake.frozen import NOTHING
from atlas_drake.logs.formats import LogFile
from atlas_drake.logs.notes import (
    COMMANDS,
    LogError,
    Note,
    note_from_event,
    note_from_plan,
    to_plain,
)
from atlas_drake.logs.samples import RowSampler
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import Event
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.scratch import declare_scratch_context

_VALUES = (
    "commands",
    "controller_status",
    "atlas_sim_interface_state",
    "imu",
)
"""Ports with abstract values."""


PATHS_EVERY = 0.1
"""Time between two records of the planned paths, which change slowly [s]."""


class LogRecorder(CollectableSystem):
    """Writes the values of a station's ports to a log.

    A discrete update samples a row: it reads the controller's output of the same
    instant. A publish event writes the row one tick later, as for all output from a
    diagram.

    Input ports, as the station's outputs of the same names:
        state, behavior_state, foot_wrenches, hand_wrenches, effort, user_effort,
        behavior_effort, commands, controller_status, atlas_sim_interface_state, imu

    State: the row sampled last, shape (layout's width,). The record of what has been
    written is kept in this object and not in a Context, because it belongs to the file.

    Attributes:
        fault: Error that ended the writing; None if there was none.
    """

    __slots__ = ()

    def __init__(
        self,
        sampler: RowSampler,
        writer: LogFile,
        period: float,
        tick_seconds: Sequence[float] = (),
    ):
        """Samples every ``period`` [s].

        Args:
            sampler: Sampler of the station's robot.
            writer: Writer of rows and notes.
            period: The control period [s].
            tick_seconds: Wall times of the controller's ticks, which it appends to.
        """
        super().__init__()
        self._sampler = sampler
        self._writer = writer
        self.fault: LogError | None = None
        self._tick_seconds = tick_seconds
        self._ports: dict[str, InputPort] = {}
        for name, size in sampler.port_sizes.items():
            self._ports[name] = self.DeclareVectorInputPort(name, size)
        for name in _VALUES:
            self._ports[name] = self.DeclareAbstractInputPort(
                name, AbstractValue.Make(NOTHING)
            )
        self._scratch = declare_scratch_context(self, sampler.create_context)
        self._row = self.DeclareDiscreteState(np.full(sampler.layout.width, np.nan))
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._sample)
        self.DeclarePeriodicPublishEvent(period, 0.0, self._write)
        self._written_time = -np.inf
        self._paths_time, self._planned = -np.inf, False
        self._received = 0

    # ---- writing -------------------------------------------------------------

    def event(self, event: Event) -> None:
        """Records an event that no port holds in full."""
        with self._latched_fault():
            self._writer.note(note_from_event(event))

    def flush(self, context: Context) -> None:
        """Writes the latest row and commands now, not one tick later."""
        self._write(context)

    def close(self) -> None:
        """Completes the log and ends recording.

        Raises:
            LogError: If the log cannot be written, now or at an earlier tick.
        """
        if self.fault is not None:
            raise self.fault
        self._writer.close()

    @contextmanager
    def _latched_fault(self) -> Iterator[None]:
        """Continues the simulation when the log cannot be written."""
        try:
            yield
        except LogError as error:
            self.fault = error

    def _write(self, context: Context) -> None:
        if self.fault is not None:
            return
        row = context.get_discrete_state(self._row).value().copy()
        time = row[0]
        commands: Any = self._ports["commands"].Eval(context)
        fresh = commands.messages_since(self._received)
        self._received = commands.received
        with self._latched_fault():
            for received in fresh:
                for kind, cls in COMMANDS.items():
                    # A value that is not a command appears in the event of its refusal.
                    if isinstance(received.message, cls):
                        plain = to_plain(received.message)
                        self._writer.note(Note(received.time, kind, plain))
            # No row exists before the first tick; after a reset Drake publishes again.
            if time > self._written_time:
                self._written_time = time
                self._writer.row(row)
                self._write_paths(context)

    def _write_paths(self, context: Context) -> None:
        """Records the planned paths periodically, and when they appear or end."""
        time = context.get_time()
        status: ControllerStatus = self._ports["controller_status"].Eval(context)
        planned = status.plan.preview is not None or bool(status.plan.footsteps)
        late = planned and time > self._paths_time + PATHS_EVERY - 1e-9
        if late or planned != self._planned:
            self._paths_time, self._planned = time, planned
            self._writer.note(note_from_plan(time, status.plan))

    # ---- sampling ------------------------------------------------------------

    def _sample(self, context: Context, discrete: DiscreteValues) -> None:
        row = self._sampler.row(
            self._scratch.Eval(context),
            context.get_time(),
            self._tick_seconds[-1] if self._tick_seconds else np.nan,
            {name: port.Eval(context) for name, port in self._ports.items()},
        )
        discrete.get_mutable_vector(self._row).SetFromVector(row)


def add_log_recorder(
    builder: DiagramBuilder, station: System, recorder: LogRecorder
) -> None:
    """Adds a recorder to a diagram and connects it.

    Args:
        builder: Builder of the diagram that holds the station.
        station: An AtlasStation.
        recorder: Recorder of the station's robot.
    """
    builder.AddNamedSystem("log_recorder", recorder)
    for index in range(recorder.num_input_ports()):
        port = recorder.get_input_port(index)
        builder.Connect(station.GetOutputPort(port.get_name()), port)
