"""What a standing behavior does while the user leaves it no leg to balance with.

A leg to balance with is one of whose hip pitch and ankle pitch both the behavior
commands at least the ``balance_effort`` of the robot's file. Without one the behavior
holds its pose, as FREEZE does. Balancing all the same would move the center of mass by
what trunk and arms can do, lean further and further, and fall. With a leg given back it
takes up what it was about.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.freeze import Freeze, FreezeMemory
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.event import Event
from atlas_drake.robot import ANKLE_PITCH, HIP_PITCH


@dataclass(frozen=True)
class Holding:
    """What is remembered while the pose is held.

    Attributes:
        pose: FREEZE's memory.
        before: That of the behavior.
        warned: Whether the user was told.
    """

    pose: FreezeMemory
    before: Any
    warned: bool = False


class StandingBehavior(BehaviorProtocol, Protocol):
    """A behavior that can be interrupted while its pose is held."""

    def idle(self, memory: Any, observation: Observation) -> Any:
        """The memory after a tick in which the pose was held."""

    def resume(
        self,
        memory: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> Any:
        """The memory with which it goes on from where the robot is now."""


class StanceGuard:
    """A standing behavior, interrupted whenever it is without a leg.

    Attributes:
        behavior: Who balances.
    """

    def __init__(self, behavior: StandingBehavior, freeze: Freeze, balance: Balance):
        """Runs ``behavior`` where it can balance, else ``freeze``."""
        self.behavior = behavior
        self._freeze = freeze
        robot = balance.robot
        self._pitch = np.array(
            [leg.joints[[HIP_PITCH, ANKLE_PITCH]] for leg in robot.legs]
        )
        self._least_effort = robot.file.balance_effort
        names = [
            " and ".join(robot.joint_names[joint] for joint in leg)
            for leg in self._pitch
        ]
        self._warning = (
            "no leg to balance with: only the pose is held. It takes hip and ankle "
            f"pitch of one leg, {' or '.join(names)}, and {self._least_effort:.0f} N·m "
            "of each"
        )
        self._limit = robot.effort_limit[self._pitch]

    def enter(
        self,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> Any:
        """The behavior's own memory."""
        return self.behavior.enter(observation, body, request)

    def update(
        self,
        memory: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """One tick."""
        if self.has_a_leg(observation):
            if isinstance(memory, Holding):
                memory = self.behavior.resume(memory.before, observation, body, request)
            return self.behavior.update(memory, observation, body, request, leaving)
        if not isinstance(memory, Holding):
            memory = Holding(
                self._freeze.enter(observation, body, request), before=memory
            )
        # Who takes every joint knows that nobody balances.
        warn = not memory.warned and not observation.user_held.all()
        outcome = self._freeze.update(memory.pose, observation, body, request, leaving)
        return replace(
            outcome,
            memory=Holding(
                pose=outcome.memory,
                before=self.behavior.idle(memory.before, observation),
                warned=memory.warned or warn,
            ),
            finished=leaving,
            events=(Event(observation.time, "warning", self._warning),) if warn else (),
        )

    def plan(self, memory: Any, com: np.ndarray, omega: float) -> Plan:
        """The behavior's plan; none while only the pose is held."""
        if isinstance(memory, Holding):
            return Plan()
        return self.behavior.plan(memory, com, omega)

    def report(self, memory: Any, state: AtlasSimInterfaceState) -> None:
        """What the behavior has to say."""
        if isinstance(memory, Holding):
            memory = memory.before
        self.behavior.report(memory, state)

    def has_a_leg(self, observation: Observation) -> bool:
        """Whether there is a leg to balance with.

        It takes hip and ankle pitch of the same leg: one keeps the trunk upright, the
        other moves the center of pressure. Sideways the stance of two feet is stable
        whoever holds the joints.
        """
        left_over = (1.0 - observation.user_share[self._pitch]) * self._limit
        return any(min(leg) >= self._least_effort for leg in left_over.tolist())
