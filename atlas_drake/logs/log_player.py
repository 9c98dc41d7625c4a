"""The ports of a station, fed from a log.

How they are shown is in ``replay``.
"""

from __future__ import annotations

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from atlas_drake.behaviors.base import Event
from atlas_drake.behaviors.supervisor import KEPT_EVENTS, SupervisorState
from atlas_drake.frozen import replace
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log
from atlas_drake.logs.notes import LogError
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    behavior_from,
)
from atlas_drake.messages.commands import (
    BehaviorRequest,
    CommandsInForce,
    commands_at_start,
)
from atlas_drake.systems.behavior_controller import ControllerState
from atlas_drake.systems.collectable_system import CollectableSystem

VECTORS = {
    "state": ("state.q", "state.v"),
    "effort": ("joints.effort",),
    "foot_wrenches": tuple(
        f"feet.{side}_{part}" for side in SIDES for part in ("torque", "force")
    ),
}
"""Channels of which the ports that carry plain vectors are made."""


class LogPlayer(CollectableSystem):
    """The log's row at the Context's time, as the ports that displays read.

    Output ports:
        state: Of the plant, the true one.
        effort: Of the motors [N·m], shape (n,).
        foot_wrenches: See ``RobotSensors``, shape (12,).
        commands: ``CommandsInForce``, as far as displays need it: the request, and
            who has which joint.
        controller_state: ``ControllerState``, likewise: the events so far.
        atlas_sim_interface_state: ``AtlasSimInterfaceState``, all of it.
    """

    __slots__ = ()

    def __init__(self, log: Log):
        """Plays ``log``; beyond its ends the first or the last row stands.

        Raises:
            LogError: If the log lacks what is to be shown.
        """
        super().__init__()
        _check_complete(log)
        self._log = log
        self._requests = _requests(log)
        start = commands_at_start(log.robot, Behavior.STAND)
        nothing = np.zeros(log.robot.num_joints)
        idle = ControllerState(SupervisorState(Behavior.STAND, Behavior.STAND), nothing)
        self._start, self._idle = start, idle
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
        for name, blank, calc in (
            ("commands", start, self._commands),
            ("controller_state", idle, self._controller_state),
            ("atlas_sim_interface_state", AtlasSimInterfaceState(), self._report),
        ):
            self.DeclareAbstractOutputPort(
                name,
                lambda blank=blank: AbstractValue.Make(blank),
                lambda context, out, calc=calc: out.set_value(calc(context)),
                now,
            )

    def row(self, context: Context) -> int:
        """Number of the row that is shown: the latest that is not in the future."""
        time = self._log.time
        # A hair of slack: times are sums of rounded periods.
        after = np.searchsorted(time, context.get_time() + 1e-9, side="right")
        return max(int(after) - 1, 0)

    def _commands(self, context: Context) -> CommandsInForce:
        log, row = self._log, self.row(context)
        number = int(log["behavior.request_number"][row])
        request = self._requests.get(number, self._start.request)
        k_effort = log["joints.k_effort"][row].astype(float)
        joints = replace(self._start.joints, k_effort=k_effort)
        return replace(self._start, requests=(request,), joints=joints)

    def _controller_state(self, context: Context) -> ControllerState:
        # The latest events, as in the controller.
        now = context.get_time() + 1e-9
        past: list[Event] = [e for e in self._log.events if e.time <= now]
        supervisor = replace(
            self._idle.supervisor,
            events=tuple(past[-KEPT_EVENTS:]),
            event_count=len(past),
        )
        return replace(self._idle, supervisor=supervisor)

    def _report(self, context: Context) -> AtlasSimInterfaceState:
        log, row = self._log, self.row(context)
        names = (entry.channel.name for entry in REPORT_CHANNELS)
        report = report_from({name: log[name][row] for name in names})
        report.header.stamp = float(log.time[row])
        report.f_out = log["joints.behavior_effort"][row].tolist()
        report.k_effort = log["joints.k_effort"][row].tolist()
        return report


def _check_complete(log: Log) -> None:
    """Refuses the log of a program that kept less."""
    needed = [
        *(channel for channels in VECTORS.values() for channel in channels),
        *(entry.channel.name for entry in REPORT_CHANNELS),
    ]
    missing = [name for name in needed if name not in log.arrays]
    if missing:
        raise LogError(
            f"{log.path}: it was recorded without {', '.join(missing)}, so that it "
            "cannot be replayed; record it anew"
        )


def _requests(log: Log) -> dict[int, BehaviorRequest]:
    """The behaviour commands that were accepted, by their number."""
    requests = {}
    numbers, times = log["behavior.request_number"], log.time
    for command in log.commands:
        message = command.message
        row = int(np.searchsorted(times, command.time - 1e-9))
        if not isinstance(message, AtlasSimInterfaceCommand) or row >= len(times):
            continue
        number = int(numbers[row])
        # A refused command leaves the number as it was.
        if number > (int(numbers[row - 1]) if row else 0):
            behavior = behavior_from(message.behavior)
            requests[number] = BehaviorRequest(behavior, message.snapshot(), number)
    return requests
