"""Sends a programme of commands at given times, and passes on those of others.

A programme is a list of messages, or of functions that make one from the latest
feedback: footsteps, for example, are thought of in the robot's frame and have to be
moved to the world frame when they are sent. Entries of the same time are sent in their
order, one in each tick, so that none takes another's place on its port.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, State, ValueProducer

from atlas_drake.frozen import NOTHING, Frozen, replace
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Imu,
)
from atlas_drake.messages.base import frozen, is_new
from atlas_drake.messages.commands import Command
from atlas_drake.systems.collectable_system import CollectableSystem


@dataclass(frozen=True)
class Feedback:
    """What a commander knows of the robot when it sends a command."""

    time: float
    atlas_state: AtlasState
    atlas_sim_interface_state: AtlasSimInterfaceState
    imu: Imu


@dataclass(frozen=True)
class ScheduledCommand:
    """One entry of a programme.

    Attributes:
        time: When to send it [s].
        command: The message, or a pure function that makes it from the feedback;
            None only says the text.
        text: What to tell the user when it is sent.
    """

    time: float
    command: Command | Callable[[Feedback], Command] | None
    text: str = ""


@dataclass(frozen=True)
class SchedulerState(Frozen):
    """What has been sent.

    Attributes:
        sent: Entries of the programme sent so far.
        atlas_command: On the output port; NOTHING at first.
        sim_command: Likewise.
        seen_atlas: What ``is_new`` has seen of other commanders' joint commands.
        seen_sim: Likewise of behavior commands.
    """

    sent: int = 0
    atlas_command: Any = NOTHING
    sim_command: Any = NOTHING
    seen_atlas: Any = NOTHING
    seen_sim: Any = NOTHING


class CommandScheduler(CollectableSystem):
    """A programme and other commanders' messages in, the two command ports out.

    Input ports:
        atlas_state, atlas_sim_interface_state, imu: The latest feedback.
        other_atlas_command, other_atlas_sim_interface_command: Messages of a script or
            a panel; optional, and like those of a ``CommandInterface``. Passed on at
            once; the later message wins.

    Output ports:
        atlas_command: ``AtlasCommand`` or NOTHING.
        atlas_sim_interface_command: ``AtlasSimInterfaceCommand`` or NOTHING.
        sent: How many entries of the programme have been sent.
    """

    __slots__ = ()

    def __init__(self, programme: Sequence[ScheduledCommand], period: float):
        """Looks at the clock every ``period`` [s]."""
        super().__init__()
        self.programme = tuple(sorted(programme, key=lambda entry: entry.time))
        self._feedback = [
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in ("atlas_state", "atlas_sim_interface_state", "imu")
        ]
        self._others = [
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in ("other_atlas_command", "other_atlas_sim_interface_command")
        ]
        self._state = self.DeclareAbstractState(AbstractValue.Make(SchedulerState()))
        others = {self.input_port_ticket(port.get_index()) for port in self._others} | {
            self.xa_ticket()
        }
        self._now = self.DeclareCacheEntry(
            "messages on the output ports",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(SchedulerState()),
                calc=self.callback(self._calc_now),
            ),
            others,
        )
        now = {self._now.ticket()}
        self.DeclareAbstractOutputPort(
            "atlas_command",
            lambda: AbstractValue.Make(NOTHING),
            lambda context, out: out.set_value(self._now.Eval(context).atlas_command),
            prerequisites_of_calc=now,
        )
        self.DeclareAbstractOutputPort(
            "atlas_sim_interface_command",
            lambda: AbstractValue.Make(NOTHING),
            lambda context, out: out.set_value(self._now.Eval(context).sim_command),
            prerequisites_of_calc=now,
        )
        self.DeclareAbstractOutputPort(
            "sent",
            lambda: AbstractValue.Make(0),
            lambda context, out: out.set_value(self._now.Eval(context).sent),
            prerequisites_of_calc=now,
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def _calc_now(self, context: Context, result: AbstractValue) -> None:
        state: SchedulerState = context.get_abstract_state(self._state).get_value()
        atlas, sim = (
            port.Eval(context) if port.HasValue(context) else NOTHING
            for port in self._others
        )
        if is_new(atlas, state.seen_atlas):
            message = frozen(atlas)
            state = replace(state, atlas_command=message, seen_atlas=message)
        if is_new(sim, state.seen_sim):
            message = frozen(sim)
            state = replace(state, sim_command=message, seen_sim=message)
        result.set_value(state)

    def _update(self, context: Context, state: State) -> None:
        after = self._now.Eval(context)
        # A hair of slack: times are sums of rounded periods.
        now = context.get_time() + 1e-9
        if after.sent < len(self.programme) and self.programme[after.sent].time <= now:
            after = self._send(context, after, self.programme[after.sent])
        state.get_mutable_abstract_state(self._state).set_value(after)

    def _send(
        self, context: Context, state: SchedulerState, entry: ScheduledCommand
    ) -> SchedulerState:
        state = replace(state, sent=state.sent + 1)
        command = entry.command
        if callable(command):
            command = command(
                Feedback(
                    context.get_time(),
                    *(port.Eval(context) for port in self._feedback),
                )
            )
        if command is None:
            return state
        # A programme counts down, and so uses no number of another commander's.
        message = command.numbered(-state.sent)
        if isinstance(message, AtlasCommand):
            return replace(state, atlas_command=message)
        return replace(state, sim_command=message)
