"""Records a station: one row of numbers per control tick, and notes beside it.

What a row holds is made in ``samples``. Files are the business of its writer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import ContactResults
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
    "contact_results",
)
"""Ports whose values are no vectors."""


PATHS_EVERY = 0.1
"""Time between two records of the planned paths, which change slowly [s]."""


class LogRecorder(CollectableSystem):
    """Ports of a station in, a log out.

    A row is sampled by a discrete update, which sees what the controller decided at
    the same instant and reads the contact forces that the plant is about to solve
    anyway. It is written a tick later, by a publish event, as is everything that
    leaves a diagram.

    Input ports, as the station's outputs of the same names:
        state, behavior_state, foot_wrenches, effort, user_effort, behavior_effort
        commands, controller_status, atlas_sim_interface_state, imu, contact_results

    State: the row sampled last, shape (layout's width,). What has been written
    already is known here and not in a Context: it is a fact about the file.

    Attributes:
        fault: Why nothing is written any more; None while all is well.
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
            sampler: Of the station's robot.
            writer: Takes rows and notes.
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
            blank = ContactResults() if name == "contact_results" else NOTHING
            self._ports[name] = self.DeclareAbstractInputPort(
                name, AbstractValue.Make(blank)
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
        """Records an event, which no port says in full."""
        with self._latched_fault():
            self._writer.note(note_from_event(event))

    def flush(self, context: Context) -> None:
        """Writes the latest row and commands, which otherwise wait for a tick."""
        self._write(context)

    def close(self) -> None:
        """Completes the log; nothing is recorded any more.

        Raises:
            LogError: If the log cannot be written, now or at an earlier tick.
        """
        if self.fault is not None:
            raise self.fault
        self._writer.close()

    @contextmanager
    def _latched_fault(self) -> Iterator[None]:
        """Lets the simulation go on when the log cannot be written."""
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
                    # What is no command is in the event that tells of its refusal.
                    if isinstance(received.message, cls):
                        plain = to_plain(received.message)
                        self._writer.note(Note(received.time, kind, plain))
            # There is none before the first tick; after a reset Drake publishes again.
            if time > self._written_time:
                self._written_time = time
                self._writer.row(row)
                self._write_paths(context)

    def _write_paths(self, context: Context) -> None:
        """Notes the planned paths from time to time, and when they come or go."""
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
        builder: Of the diagram that holds the station.
        station: An AtlasStation.
        recorder: Of the station's robot.
    """
    builder.AddNamedSystem("log_recorder", recorder)
    for index in range(recorder.num_input_ports()):
        port = recorder.get_input_port(index)
        builder.Connect(station.GetOutputPort(port.get_name()), port)
