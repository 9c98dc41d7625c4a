"""The ports of a station, fed from a log.

``diagrams.replay`` connects the ports to displays.
"""

from __future__ import annotations

from bisect import bisect_right
from operator import attrgetter

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.frozen import replace
from atlas_drake.logs.channels import NO_QP, polygon_from
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log
from atlas_drake.logs.notes import (
    FEEDBACK,
    PATHS,
    LogError,
    Note,
    footsteps_from_note,
    paths_from_note,
)
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.logs.world_state import PlantState
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.messages.commands import (
    ActiveCommand,
    BehaviorRequest,
    commands_at_start,
)
from atlas_drake.messages.controller_status import (
    KEPT_EVENTS,
    ControllerStatus,
    Plan,
    PlannedPaths,
)
from atlas_drake.messages.event import Event
from atlas_drake.systems.collectable_system import CollectableSystem

VECTORS = {
    "state": ("state.q", "state.v"),
    "effort": ("joints.effort",),
    "behavior_effort": ("joints.behavior_effort",),
    "foot_wrenches": tuple(
        f"feet.{side}_{part}" for side in SIDES for part in ("torque", "force")
    ),
}
"""Channels that feed the vector-valued ports."""


class LogPlayer(CollectableSystem):
    """Outputs the log's row at the Context's time on the ports that displays read.

    Output ports:
        state: True state of the robot.
        plant_state: State of the whole plant.
        effort: Efforts of the motors [N·m], shape (n,).
        foot_wrenches: See ``RobotSensors``, shape (12,).
        commands: ``ActiveCommand``, as far as displays need it: the request, and the
            shares of user control.
        behavior_effort: Efforts of the controller [N·m], shape (n,).
        controller_status: ``ControllerStatus``: behavior, latest events and plan.
        planned_paths: ``PlannedPaths``
        atlas_sim_interface_state: ``AtlasSimInterfaceState``, all of it.
    """

    __slots__ = ()

    def __init__(self, log: Log, plant: MultibodyPlant | None = None):
        """Plays ``log``; beyond its ends the first or the last row is shown.

        Args:
            log: Log of the run.
            plant: Plant of the display, with robot and world; None is the robot alone.

        Raises:
            LogError: If the log lacks a required channel.
        """
        super().__init__()
        _check_complete(log)
        self._log = log
        self._requests = _requests(log)
        start = commands_at_start(log.robot, Behavior.STAND, log.header.catalog)
        self._start = start
        self._paths = [note for note in log.notes if note.kind == PATHS]
        self._feedback = [note for note in log.notes if note.kind == FEEDBACK]
        now = {self.time_ticket()}
        for name, channels in VECTORS.items():
            tables = [log[channel] for channel in channels]
            self.DeclareVectorOutputPort(
                name,
                sum(table.shape[1] for table in tables),
                lambda context, out, tables=tables: out.SetFromVector(
                    np.concatenate([table[self.row(context)] for table in tables])
                ),
                now,
            )
        labels = {entry.name: entry.labels for entry in log.header.layout.channels}
        plant_state = PlantState(plant or log.robot.make_plant(), log.robot, labels)
        self.DeclareVectorOutputPort(
            "plant_state",
            plant_state.size,
            lambda context, out: out.SetFromVector(
                plant_state.at(log.arrays, self.row(context))
            ),
            now,
        )
        for name, blank, calc in (
            ("commands", start, self._commands),
            ("controller_status", ControllerStatus(), self._status),
            ("planned_paths", PlannedPaths(), self._planned_paths),
            ("atlas_sim_interface_state", AtlasSimInterfaceState(), self._report),
        ):
            self.DeclareAbstractOutputPort(
                name,
                lambda blank=blank: AbstractValue.Make(blank),
                lambda context, out, calc=calc: out.set_value(calc(context)),
                now,
            )

    def row(self, context: Context) -> int:
        """Number of the displayed row: the latest row that is not in the future."""
        time = self._log.time
        # A small tolerance, because times are sums of rounded periods.
        after = np.searchsorted(time, context.get_time() + 1e-9, side="right")
        return max(int(after) - 1, 0)

    def _commands(self, context: Context) -> ActiveCommand:
        log, row = self._log, self.row(context)
        number = int(log["behavior.request_number"][row])
        request = self._requests.get(number, self._start.request)
        k_effort = log["joints.k_effort"][row].astype(float)
        joints = replace(self._start.joints, k_effort=k_effort)
        return replace(self._start, requests=(request,), joints=joints)

    def _status(self, context: Context) -> ControllerStatus:
        row = self.row(context)
        # The latest events, as in the status of a controller.
        now = context.get_time() + 1e-9
        past: list[Event] = [e for e in self._log.events if e.time <= now]
        return ControllerStatus(
            current_behavior=self._log.behavior(
                int(self._log["behavior.current"][row])
            ),
            events=tuple(past[-KEPT_EVENTS:]),
            event_count=len(past),
            solved=self._solved(row),
            unsolved=int(self._log["controller.unsolved"][row]),
            plan=self._plan(row, now),
        )

    def _solved(self, row: int) -> bool | None:
        """Whether the last QP had a solution; earlier versions did not log it."""
        solved = self._log.arrays.get("controller.solved")
        if solved is None or solved[row] == NO_QP:
            return None
        return bool(solved[row])

    def _plan(self, row: int, now: float) -> Plan:
        """Plan at a row; logs of earlier versions lack parts of it."""
        kept = {
            name: self._log[f"balance.{name}"][row]
            for name in ("com_reference", "dcm_reference", "cop_reference")
            if f"balance.{name}" in self._log.arrays
        }
        support = self._log.arrays.get("balance.support")
        note = _latest(self._paths, now)
        return Plan(
            **{name: value for name, value in kept.items() if np.isfinite(value).all()},
            support=None if support is None else polygon_from(support[row]),
            footsteps=() if note is None else footsteps_from_note(note),
        )

    def _planned_paths(self, context: Context) -> PlannedPaths:
        note = _latest(self._paths, context.get_time() + 1e-9)
        return PlannedPaths() if note is None else paths_from_note(note)

    def _report(self, context: Context) -> AtlasSimInterfaceState:
        log, row = self._log, self.row(context)
        names = (entry.channel.name for entry in REPORT_CHANNELS)
        report = report_from({name: log[name][row] for name in names})
        report.current_behavior = log.behavior(report.current_behavior)
        report.desired_behavior = log.behavior(report.desired_behavior)
        report.header.stamp = float(log.time[row])
        report.f_out = log["joints.behavior_effort"][row].tolist()
        report.k_effort = log["joints.k_effort"][row].tolist()
        note = _latest(self._feedback, context.get_time() + 1e-9)
        report.feedback = None if note is None else note.data[FEEDBACK]
        return report


def _latest(notes: list[Note], now: float) -> Note | None:
    """The last note until now, if any; one without content marks an end."""
    place = bisect_right(notes, now, key=attrgetter("time"))
    return notes[place - 1] if place else None


def _check_complete(log: Log) -> None:
    """Refuses the log of an earlier version that lacks required channels."""
    needed = [
        *(channel for channels in VECTORS.values() for channel in channels),
        *(entry.channel.name for entry in REPORT_CHANNELS),
    ]
    missing = [name for name in needed if name not in log.arrays]
    if missing:
        raise LogError(
            f"{log.path}: it was recorded without {', '.join(missing)}, so that it "
            "cannot be replayed; record it again"
        )


def _requests(log: Log) -> dict[int, BehaviorRequest]:
    """The behavior commands that were accepted, by their number."""
    requests = {}
    numbers, times = log["behavior.request_number"], log.time
    for command in log.commands:
        message = command.message
        row = int(np.searchsorted(times, command.time - 1e-9))
        if not isinstance(message, AtlasSimInterfaceCommand) or row >= len(times):
            continue
        number = int(numbers[row])
        # A refused command does not change the number.
        if number > (int(numbers[row - 1]) if row else 0):
            behavior = log.header.catalog.find(message.behavior)
            requests[number] = BehaviorRequest(behavior, message.freeze(), number)
    return requests
