"""A policy as a user: a system before the station's command port."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, State

from atlas_drake.clients.policies.network import Memory
from atlas_drake.clients.policies.policy_joints import (
    History,
    PolicyJoints,
    observation_of,
)
from atlas_drake.clients.policies.reading import Policy
from atlas_drake.frozen import NOTHING, Frozen, read_only, replace
from atlas_drake.messages.event import Event, RunEvent
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.robot import Robot
from atlas_drake.scenario.policy_use import STICK
from atlas_drake.simulation.sockets import CollectableSystem

SYSTEM = "policy"
"""Name of the system in the diagram."""
POLICY = "policy"
"""Kind of the event for a policy that gives its joints up."""
_INPUTS = ("atlas_state", "imu", "commands")


@dataclass(frozen=True)
class PolicyState(Frozen):
    """What a policy hands on from one action to the next."""

    memory: Memory
    action: np.ndarray  # The last one, shape (m,)
    seen: History = ()
    actions: int = 0  # Number of them since the policy took its joints
    runs: bool = False  # True while the joints are the policy's
    ended: Event | None = None  # Why it gave them up


class PolicyUser(CollectableSystem):
    """A policy that commands its joints with ``k_effort`` 255, at its own rate.

    It leaves the other joints as they are: to the behavior, or to a person. It gives
    its joints up, and says nothing more, once somebody else's command leaves it less
    than all of one of them; or once its network answers with what is no number.

    Input ports:
        atlas_state: ``AtlasState``
        imu: ``Imu``
        commands: ``ActiveCommand``, the commands in force.

    Output ports, which are state:
        atlas_command: ``AtlasCommand``, frozen; NOTHING before the first action.

    Attributes:
        policy: The policy.
        joints: Its joints.
        fastest: Velocity that keys and sticks ask for at their ends, shape (3,).
    """

    __slots__ = ()

    def __init__(
        self,
        policy: Policy,
        robot: Robot,
        *,
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
        fastest: Sequence[float] = STICK,
        start: float = 0.0,
    ):
        """Makes the system.

        Args:
            policy: The policy.
            robot: The robot of the station.
            velocity: Desired velocity at first: ahead, left [m/s], turn [rad/s].
            fastest: Velocity that keys and sticks ask for at their ends, likewise.
            start: Time at which the policy takes its joints [s].

        Raises:
            ScenarioError: If the robot lacks a joint of the policy.
        """
        super().__init__()
        self.policy, self._start = policy, start
        self.fastest = np.array(fastest, dtype=float)
        self.joints = PolicyJoints(policy.description, robot, policy.terms)
        self._inputs = [self.declare_value_input(name) for name in _INPUTS]
        self._message = self.declare_value_state(NOTHING, "atlas_command")
        self._velocity = self.DeclareDiscreteState(np.array(velocity, dtype=float))
        self._state = self.declare_value_state(self._at_rest())
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            policy.description.period, 0.0, self._update
        )

    # ---- for clients ---------------------------------------------------------

    def velocity(self, context: Context) -> np.ndarray:
        """Returns the desired velocity: ahead, left [m/s], turn [rad/s], shape (3,)."""
        return context.get_discrete_state(self._velocity).get_value().copy()

    def steer(self, context: Context, velocity: Sequence[float] | np.ndarray) -> None:
        """Sets the desired velocity."""
        context.SetDiscreteState(self._velocity, np.array(velocity, dtype=float))

    def take(self, context: Context) -> None:
        """Lets the policy take its joints again, with an empty memory."""
        self._state.set(context, replace(self._at_rest(), runs=True))

    def stop(self, context: Context, why: str) -> None:
        """Lets the policy say nothing more; its last set-points stay in force."""
        self._give_up(context, context.get_mutable_state(), why)

    def runs(self, context: Context) -> bool:
        """Returns True while the joints are the policy's."""
        return bool(self._state.get(context).runs)

    def ended(self, context: Context) -> Event | None:
        """Returns the event of the policy giving its joints up; None if it did not."""
        ended: Event | None = self._state.get(context).ended
        return ended

    # ---- one action ----------------------------------------------------------

    def _at_rest(self) -> PolicyState:
        action = np.zeros(len(self.joints.indices))
        start = PolicyState(self.policy.network.start(), action)
        return read_only(start)

    def _update(self, context: Context, state: State) -> None:
        last: PolicyState = self._state.get(context)
        if not (last.runs or last.ended) and context.get_time() >= self._start - 1e-9:
            last = replace(last, runs=True)
        if not last.runs:
            return
        measured, imu, commands = (port.Eval(context) for port in self._inputs)
        shares = commands.k_effort[self.joints.indices]
        if last.actions and (shares < K_EFFORT_MAX).any():
            self._give_up(context, state, "somebody else has taken its joints")
            return
        velocity = self.velocity(context)
        here = self.joints.see(
            measured, imu, last.action, velocity, last.actions, last.seen
        )
        action, memory = self.policy.network.act(observation_of(here), last.memory)
        if not np.isfinite(action).all():
            self._give_up(context, state, "its action is not a number")
            return
        after = replace(
            last, memory=memory, action=action, seen=here, actions=last.actions + 1
        )
        self._state.set(state, read_only(after, last))
        self._message.set(state, self.joints.command(action, commands.joints))

    def _give_up(self, context: Context, state: State, why: str) -> None:
        last, text = self._state.get(context), f"the policy gives its joints up: {why}"
        ended = RunEvent(context.get_time(), POLICY, text)
        self._state.set(state, replace(last, runs=False, ended=ended))


def add_policy(builder: DiagramBuilder, station: Diagram, user: PolicyUser) -> None:
    """Connects a policy to a station: ``extend=partial(add_policy, user=user)``."""
    builder.AddNamedSystem(SYSTEM, user)
    for name in _INPUTS:
        builder.Connect(station.GetOutputPort(name), user.GetInputPort(name))
    command = station.GetInputPort("atlas_command")
    builder.Connect(user.GetOutputPort("atlas_command"), command)
