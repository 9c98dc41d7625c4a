"""Records a station: one row of numbers per control tick, and notes beside it.

``rows`` computes the rows; the writer of the log's format writes files.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.common.yaml import yaml_dump
from pydrake.systems.framework import (
    Context,
    DiagramBuilder,
    DiscreteValues,
    System,
)
from pydrake.systems.primitives import Multiplexer

from atlas_drake.checked import as_plain
from atlas_drake.frozen import NOTHING
from atlas_drake.logs.channels import Tick
from atlas_drake.logs.formats import LogFile
from atlas_drake.logs.notes import (
    COMMANDS,
    FEEDBACK,
    Header,
    LogError,
    Note,
    note_from_event,
    note_from_feedback,
    note_from_plan,
    to_plain,
)
from atlas_drake.logs.rows import RowMaker
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import Event
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.time_grid import on_common_grid
from atlas_drake.scenario.world import WorldMaker
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.interface_reporter import behavior_report

VALUES = ("commands", "controller_status", "imu", "planned_paths")
"""Input ports with abstract values, as the station's outputs of the same names."""
NUMBERS = "numbers"
"""Input port with the numbers of all others."""
BLOCK = 16
"""Number of rows that are computed and written together, in half the time that they
take one by one between the steps of a simulation."""
PATHS_EVERY = 0.1
"""Time between two records of the planned paths, which change slowly [s]."""


class LogRecorder(CollectableSystem):
    """Writes the values of a station's ports to a log.

    A discrete update takes a sample: it reads the controller's output of the same
    instant. A publish event takes it to the file one tick later, as for all output from
    a diagram; there BLOCK of them become rows together.

    Input ports:
        numbers: The station's outputs in ``port_sizes``, one after the other.
        commands: ``ActiveCommand``
        controller_status: ``ControllerStatus``
        imu: ``Imu``
        planned_paths: ``PlannedPaths``

    State: the last sample, shape (size of a sample,). The record of what has been
    written is kept in this object and not in a Context, because it belongs to the file.

    Attributes:
        port_sizes: Lengths of the station's outputs that ``numbers`` is made of, by
            name, in order.
        fault: Error that ended the writing; None if there was none.
    """

    __slots__ = ()

    def __init__(
        self,
        maker: RowMaker,
        writer: LogFile,
        period: float,
        tick_seconds: Sequence[float] = (),
    ):
        """Samples every ``period`` [s]; ``tick_seconds`` as in ``start_recorder``."""
        super().__init__()
        self._maker = maker
        self._writer = writer
        self.fault: LogError | None = None
        self._tick_seconds = tick_seconds
        self.port_sizes = maker.port_sizes
        ends = np.cumsum([*maker.port_sizes.values()]).tolist()
        self._ports = dict(
            zip(maker.port_sizes, map(slice, [0, *ends], ends), strict=False)
        )
        self._numbers = self.DeclareVectorInputPort(
            NUMBERS, sum(maker.port_sizes.values())
        )
        self._commands, self._status, self._imu, self._paths = (
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in VALUES
        )
        self._latest = self.DeclareDiscreteState(np.full(maker.sample_size, np.nan))
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._sample)
        self.DeclarePeriodicPublishEvent(period, 0.0, self._write)
        self._samples: list[np.ndarray] = []
        self._sampled_time = -np.inf
        self._paths_time, self._planned = -np.inf, False
        self._planner = Behavior.NONE
        self._feedback: dict[str, Any] = {FEEDBACK: None}
        self._received = 0

    # ---- writing -------------------------------------------------------------

    def event(self, event: Event) -> None:
        """Records an event that no port holds in full."""
        with self._latched_fault():
            self._writer.note(note_from_event(event))

    def flush(self, context: Context) -> None:
        """Writes all rows, and the latest commands, now and not later."""
        self._write(context)
        if self.fault is None:
            with self._latched_fault():
                self._write_rows()

    def close(self) -> None:
        """Completes the log and ends recording.

        Raises:
            LogError: If the log cannot be written, now or at an earlier tick.
        """
        if self.fault is not None:
            raise self.fault
        try:
            self._write_rows()
        finally:
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
        commands: Any = self._commands.Eval(context)
        fresh = commands.messages_since(self._received)
        self._received = commands.received
        with self._latched_fault():
            for received in fresh:
                for kind, cls in COMMANDS.items():
                    # A value that is not a command appears in the event of its refusal.
                    if isinstance(received.message, cls):
                        plain = to_plain(received.message)
                        self._writer.note(Note(received.time, kind, plain))
            # No sample exists before the first tick; after a reset Drake publishes
            # again.
            sample = context.get_discrete_state(self._latest).value()
            if sample[0] > self._sampled_time:
                self._sampled_time = sample[0]
                self._samples.append(sample.copy())
                if len(self._samples) >= BLOCK:
                    self._write_rows()
                self._write_paths(context)
                self._write_feedback(context)

    def _write_rows(self) -> None:
        """Computes and writes the rows of all samples that were kept."""
        if self._samples:
            # Whatever interrupts the computation, the samples are still there.
            table = self._maker.rows(np.array(self._samples))
            self._samples = []
            self._writer.rows(table)

    def _write_paths(self, context: Context) -> None:
        """Records the planned paths periodically, and when the behavior changes."""
        time = context.get_time()
        status: ControllerStatus = self._status.Eval(context)
        late = time > self._paths_time + PATHS_EVERY - 1e-9
        if not late and status.current_behavior is self._planner:
            return
        self._paths_time, self._planner = time, status.current_behavior
        note = note_from_plan(time, status.plan, self._paths.Eval(context))
        planned = any(note.data.values())
        if planned or self._planned:
            self._writer.note(note)
        self._planned = planned

    def _write_feedback(self, context: Context) -> None:
        """Records the feedback of a user's own behavior when it changes."""
        note = note_from_feedback(context.get_time(), self._status.Eval(context))
        if note.data != self._feedback:
            self._feedback = note.data
            self._writer.note(note)

    # ---- sampling ------------------------------------------------------------

    def _sample(self, context: Context, discrete: DiscreteValues) -> None:
        commands: Any = self._commands.Eval(context)
        status: ControllerStatus = self._status.Eval(context)
        numbers = self._numbers.Eval(context)
        tick = Tick(
            context.get_time(),
            self._tick_seconds[-1] if self._tick_seconds else np.nan,
            {name: numbers[place] for name, place in self._ports.items()},
            commands,
            status,
            behavior_report(status, commands),
            self._imu.Eval(context),
        )
        discrete.get_mutable_vector(self._latest).SetFromVector(
            self._maker.sample(tick)
        )


def start_recorder(
    path: Path,
    scenario: Scenario,
    robot: Robot,
    world: Sequence[WorldMaker],
    tick_seconds: Sequence[float],
    behaviors: Sequence[BehaviorInterface] = (),
) -> LogRecorder:
    """Opens the file and makes the system that writes it.

    Args:
        path: Path of the file; its ending selects the format.
        scenario: The simulated scenario.
        robot: Robot of the scenario.
        world: Models in the plant beside the robot.
        tick_seconds: Wall times of the controller's ticks, which it appends to.
        behaviors: The user's own behaviors, beside the shipped ones.

    Raises:
        LogError: If the file cannot be written.
    """
    maker = RowMaker(robot, world)
    nominal = scenario.control_period
    _, period = on_common_grid(scenario.physics_step, nominal)
    text = yaml_dump(as_plain(scenario))
    header = Header(robot.model, nominal, text, maker.layout, tuple(behaviors))
    return LogRecorder(maker, LogFile(path, header), period, tick_seconds)


def add_log_recorder(
    builder: DiagramBuilder, station: System, recorder: LogRecorder
) -> None:
    """Adds a recorder to a diagram and connects it to the diagram's AtlasStation."""
    builder.AddNamedSystem("log_recorder", recorder)
    # Drake joins them in a fraction of the time that reading each of them would take.
    sizes = recorder.port_sizes
    joined = builder.AddNamedSystem("log_numbers", Multiplexer([*sizes.values()]))
    for index, name in enumerate(sizes):
        builder.Connect(station.GetOutputPort(name), joined.get_input_port(index))
    builder.Connect(joined.get_output_port(), recorder.GetInputPort(NUMBERS))
    for name in VALUES:
        builder.Connect(station.GetOutputPort(name), recorder.GetInputPort(name))
