"""Latches and merges the command ports into the commands in force.

The rules of merging are in ``messages.commands``; this is their system in the diagram.
"""

from typing import Any

from pydrake.systems.framework import Context, State

from atlas_drake.frozen import NOTHING, replace
from atlas_drake.messages import Accepted, Behavior, Refusal
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.commands import (
    COMMAND_PORTS,
    ActiveCommand,
    apply,
    commands_at_start,
    log_refusals,
    merge_ports,
)
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem


class CommandInterface(CollectableSystem):
    """Command ports in, commands in force out.

    Input ports (all optional; they hold the sender's latest message, or NOTHING
    before the first message):
        atlas_command, scheduled_atlas_command: ``AtlasCommand``
        atlas_sim_interface_command, scheduled_atlas_sim_interface_command:
            ``AtlasSimInterfaceCommand``

    A message counts once while its content stays the same; to repeat a message, a
    sender changes the header's stamp. A sender may change its message and send it
    again. A frozen message, such as ``accept`` returns, may stay on the port at no
    cost: it cannot have changed.

    Output ports:
        commands: ``ActiveCommand``; a new message is in force as soon as it is on the
            port, and remains in force after the next update.
        joint_command: ``JointCommand``
        k: The user's blend weight of each joint, 0 to 1, shape (n,).
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        period: float,
        initial_behavior: Behavior,
        catalog: BehaviorCatalog = SHIPPED,
    ):
        """Updates every ``period`` [s]; accepts the behaviors of ``catalog``."""
        super().__init__()
        self._robot, self._catalog = robot, catalog
        start = commands_at_start(robot, initial_behavior, catalog)
        self._inputs = [self.declare_value_input(name) for name in COMMAND_PORTS]
        self._state = self.declare_value_state(start)
        self._commands = self.declare_cached(
            "commands in force",
            self._merged,
            {self.all_input_ports_ticket(), self.xa_ticket()},
        )
        sources = {self._commands.ticket()}
        self.declare_value_output("commands", self._commands.Eval, sources)
        self.declare_value_output(
            "joint_command",
            lambda context: self._commands.Eval(context).joints,
            sources,
        )
        self.declare_vector_output(
            "k",
            robot.num_joints,
            lambda context: self._commands.Eval(context).joints.k,
            sources,
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def reset(self, context: Context, behavior: Behavior) -> None:
        """Restores the initial commands, with ``behavior`` requested.

        Messages on the ports count as received; the log of messages is kept.
        """
        before = self._state.get(context)
        merged: ActiveCommand = self._commands.Eval(context)
        after = replace(
            commands_at_start(self._robot, behavior, self._catalog),
            events=before.events,
            received=before.received,
            refused=before.refused,
            on_ports=merged.on_ports,
        )
        self._state.set(context, after)

    def receive(self, context: Context, outcome: Accepted | Refusal) -> Refusal | None:
        """Applies a message of a sender outside the diagram.

        The message counts as new with any content, and is applied after those on the
        ports. Several messages may be received at one instant.
        """
        before = self._commands.Eval(context)
        after, refusal = apply(before, outcome, self._robot, context.get_time())
        self._log_refusals(context, after)
        self._state.set(context, after)
        return refusal

    def _log_refusals(self, context: Context, after: ActiveCommand) -> None:
        log_refusals(self._state.get(context), after)

    def _messages(self, context: Context) -> list[Any]:
        """Returns the messages on the ports; NOTHING for a port without one."""
        return [
            port.Eval(context) if port.HasValue(context) else NOTHING
            for port in self._inputs
        ]

    def _merged(self, context: Context) -> ActiveCommand:
        before, messages = self._state.get(context), self._messages(context)
        if all(message is NOTHING for message in messages):
            return before
        return merge_ports(before, messages, self._robot, context.get_time())

    def _update(self, context: Context, state: State) -> None:
        after: ActiveCommand = self._commands.Eval(context)
        if after is not self._state.get(context):
            self._log_refusals(context, after)
            self._state.set(state, after)
