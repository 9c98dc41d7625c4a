"""Takes joints back from a user that has died: a system beside the command port."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, State

from atlas_drake.frozen import NOTHING, Frozen, replace
from atlas_drake.messages import AtlasSimInterfaceCommand, Behavior
from atlas_drake.messages.event import Event, RunEvent
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.robot import Robot
from atlas_drake.simulation.sockets import CollectableSystem

SYSTEM = "watchdog"
"""Name of the system in the diagram."""
WATCHDOG = "watchdog"
"""Kind of the event for joints that are taken back."""
LATE = 2.0
"""Age of a command at which it is late, in periods of its sender."""


@dataclass(frozen=True)
class Watch(Frozen):
    """What the watchdog has seen."""

    watches: bool  # False lets the user do what it does
    message: Any = NOTHING  # The latest one of the user
    since: float = 0.0  # When it came [s]
    barked: Event | None = None  # Why joints were taken back, the latest time


class Watchdog(CollectableSystem):
    """Requests STAND with ``k_effort`` 0 when the user of a command port has died.

    That is when no new command came for ``LATE`` periods, or one has a set-point so far
    beyond a joint's stop that it presses the joint there with more than all its torque.
    It is silent while the joints of the last command are in other hands.

    Input ports:
        atlas_command: ``AtlasCommand`` of the user, NOTHING before the first.
        commands: ``ActiveCommand``, the commands in force.

    Output ports, which are state:
        atlas_sim_interface_command: The request, frozen; NOTHING before the first.
    """

    __slots__ = ()

    def __init__(self, robot: Robot, period: float, *, watches: bool = True):
        """Expects a command every ``period`` [s]; looks twice as often."""
        super().__init__()
        self._robot, self._period = robot, period
        self._user = self.declare_value_input("atlas_command")
        self._commands = self.declare_value_input("commands")
        name = "atlas_sim_interface_command"
        self._request = self.declare_value_state(NOTHING, name)
        self._watch = self.declare_value_state(Watch(watches))
        self.DeclarePeriodicUnrestrictedUpdateEvent(0.5 * period, 0.0, self._update)

    def watches(self, context: Context) -> bool:
        """Returns True if it takes joints back."""
        return bool(self._watch.get(context).watches)

    def watch(self, context: Context, on: bool) -> None:
        """Begins to take joints back, or lets the user do what it does."""
        self._watch.set(context, replace(self._watch.get(context), watches=on))

    def barked(self, context: Context) -> Event | None:
        """Returns the latest event of joints being taken back; None if none were."""
        barked: Event | None = self._watch.get(context).barked
        return barked

    def _update(self, context: Context, state: State) -> None:
        watch, time = self._watch.get(context), context.get_time()
        message = self._user.Eval(context)
        if message is NOTHING or not watch.watches:
            return
        if message is not watch.message:
            watch = replace(watch, message=message, since=time)
            self._watch.set(state, watch)
        if watch.barked is not None and watch.barked.time >= watch.since:
            return
        mine = np.asarray(message.k_effort) == K_EFFORT_MAX
        if (self._commands.Eval(context).k_effort[mine] < K_EFFORT_MAX).any():
            return
        why = self._fault(message, mine, time - watch.since)
        if why:
            text = f"the watchdog asks for STAND with all joints: {why}"
            barked = RunEvent(time, WATCHDOG, text)
            self._watch.set(state, replace(watch, barked=barked))
            none = [0] * self._robot.num_joints
            request = AtlasSimInterfaceCommand(behavior=Behavior.STAND, k_effort=none)
            self._request.set(state, request.freeze())

    def _fault(self, message: Any, mine: np.ndarray, age: float) -> str:
        """Returns what is wrong with the user's latest command, of an ``age`` [s]."""
        if age > LATE * self._period + 1e-9:
            return f"its last command is {1e3 * age:.0f} ms old"
        robot, position = self._robot, np.asarray(message.position)
        beyond = np.maximum(
            robot.position_lower - position, position - robot.position_upper
        )
        # Policies send set-points a little beyond stops, as a way to ask for torque.
        pressed = np.asarray(message.kp_position) * beyond > robot.effort_limit
        wrong = np.flatnonzero(mine & pressed)
        if not wrong.size:
            return ""
        name, asked = robot.joint_names[wrong[0]], position[wrong[0]]
        return f"it presses {name} into its stop: set-point {asked:.2f} rad"


def add_watchdog(
    builder: DiagramBuilder, station: Diagram, dog: Watchdog, user: Any
) -> None:
    """Connects a watchdog to a station and to the system that commands its joints."""
    builder.AddNamedSystem(SYSTEM, dog)
    builder.Connect(
        user.GetOutputPort("atlas_command"), dog.GetInputPort("atlas_command")
    )
    builder.Connect(station.GetOutputPort("commands"), dog.GetInputPort("commands"))
    name = "atlas_sim_interface_command"
    builder.Connect(dog.GetOutputPort(name), station.GetInputPort(name))
