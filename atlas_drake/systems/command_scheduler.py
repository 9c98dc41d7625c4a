"""Sends scheduled commands, each at its time.

A schedule is a list of messages, or of functions that make a message from the latest
feedback: footsteps, for example, are defined in the robot's frame and transformed to
the world frame when they are sent. Entries of the same time are sent in their order,
one in each tick, so that none replaces another on its port.
"""

import copy
import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pydrake.systems.framework import Context, State

from atlas_drake.frozen import NOTHING
from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceState, AtlasState, Imu
from atlas_drake.messages.door import Command
from atlas_drake.systems.collectable_system import CollectableSystem


@dataclass(frozen=True)
class Feedback:
    """Feedback that is available to a commander when it sends a command."""

    time: float
    atlas_state: AtlasState
    atlas_sim_interface_state: AtlasSimInterfaceState
    imu: Imu


@dataclass(frozen=True)
class ScheduledCommand:
    """One entry of a schedule."""

    time: float  # To send the command [s].
    command: Command | Callable[[Feedback], Command] | None
    """The message, a pure function that makes it, or None for a text alone."""
    text: str = ""  # For the user when the command is sent.


class CommandScheduler(CollectableSystem):
    """Sends a command schedule through the two command ports.

    Input ports:
        atlas_state, atlas_sim_interface_state, imu: The latest feedback.

    Output ports, which are state:
        atlas_command: The last ``AtlasCommand``, frozen; NOTHING at first.
        atlas_sim_interface_command: The last ``AtlasSimInterfaceCommand`` likewise.
        sent: Number of sent entries of the schedule.
    """

    __slots__ = ()

    def __init__(self, schedule: Sequence[ScheduledCommand], period: float):
        """Updates every ``period`` [s]."""
        super().__init__()
        self.schedule = tuple(sorted(schedule, key=lambda entry: entry.time))
        self._feedback = [
            self.declare_value_input(name)
            for name in ("atlas_state", "atlas_sim_interface_state", "imu")
        ]
        self._last = {
            name: self.declare_value_state(start, name)
            for name, start in (
                ("atlas_command", NOTHING),
                ("atlas_sim_interface_command", NOTHING),
                ("sent", 0),
            )
        }
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def drop_rest(self, context: Context) -> None:
        """Lets the rest of the schedule count as sent."""
        self._last["sent"].set(context, len(self.schedule))

    def _update(self, context: Context, state: State) -> None:
        sent: int = self._last["sent"].get(context)
        # A small tolerance: times are sums of rounded periods.
        now = context.get_time() + 1e-9
        if sent == len(self.schedule) or self.schedule[sent].time > now:
            return
        self._last["sent"].set(state, sent + 1)
        command = self.schedule[sent].command
        if callable(command):
            feedback = (port.Eval(context) for port in self._feedback)
            command = command(Feedback(context.get_time(), *feedback))
        if command is None:
            return
        is_joint_command = isinstance(command, AtlasCommand)
        port = "atlas_command" if is_joint_command else "atlas_sim_interface_command"
        # Another object, frozen: the message is new even if it equals the one before.
        message = dataclasses.replace(copy.deepcopy(command)).freeze()
        self._last[port].set(state, message)
