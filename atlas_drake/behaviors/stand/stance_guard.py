"""The stance guard: a standing behavior without a leg to balance on holds its pose.

A behavior can balance on a leg if it commands at least ``stance.balance_effort`` at
both hip pitch and ankle pitch. Without such a leg the guard holds the pose, as FREEZE
does: balance with trunk and arms alone would make the robot lean farther and farther,
and fall. When the user gives a leg back, the behavior continues.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.freeze import Freeze, FreezeState
from atlas_drake.frozen import replace
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import Event


@dataclass(frozen=True)
class Holding:
    """State while the guard holds the pose.

    Attributes:
        pose: State of FREEZE.
        before: State of the interrupted behavior.
        warned: True after the warning.
    """

    pose: FreezeState
    before: Any
    warned: bool = False


class StanceGuard(BehaviorProtocol):
    """A standing behavior, interrupted while it has no leg to balance on.

    Attributes:
        behavior: The behavior that balances.
    """

    def __init__(self, behavior: BehaviorProtocol, freeze: Freeze, balance: Balance):
        """Runs ``behavior`` while it can balance, else ``freeze``."""
        self.behavior = behavior
        self._freeze = freeze
        robot = balance.robot
        self._pitch = np.array([[leg.hip_pitch, leg.ankle_pitch] for leg in robot.legs])
        self._least_effort = balance.stance.balance_effort
        names = [
            " and ".join(robot.joint_names[joint] for joint in leg)
            for leg in self._pitch
        ]
        self._warning = (
            "no leg to balance on: the robot only holds its pose. Balance needs hip "
            f"and ankle pitch of one leg, {' or '.join(names)}, with "
            f"{self._least_effort:.0f} N·m each"
        )
        self._limit = robot.effort_limit[self._pitch]

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Any:
        """Enters the behavior and returns its state."""
        return self.behavior.enter(observation, body, request)

    def update(
        self,
        state: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of the behavior, or of holding the pose."""
        if self.can_balance(observation):
            if isinstance(state, Holding):
                state = self.behavior.resume(state.before, observation, body, request)
            return self.behavior.update(state, observation, body, request, leaving)
        if not isinstance(state, Holding):
            state = Holding(
                self._freeze.enter(observation, body, request), before=state
            )
        # A user in control of every joint needs no warning.
        warn = not state.warned and not observation.user_held.all()
        outcome = self._freeze.update(state.pose, observation, body, request, leaving)
        return replace(
            outcome,
            state=Holding(
                pose=outcome.state,
                before=self.behavior.idle(state.before, observation),
                warned=state.warned or warn,
            ),
            finished=leaving,
            events=(Event(observation.time, "warning", self._warning),) if warn else (),
        )

    def plan(self, state: Any, com: np.ndarray, omega: float) -> Plan:
        """Returns the behavior's plan; an empty plan while the guard holds the pose."""
        if isinstance(state, Holding):
            return Plan()
        return self.behavior.plan(state, com, omega)

    def paths(self, state: Any, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the behavior's paths; none while the guard holds the pose."""
        if isinstance(state, Holding):
            return PlannedPaths()
        return self.behavior.paths(state, com, omega)

    def feedback(self, state: Any, status_flags: int) -> Any:
        """Returns the behavior's feedback."""
        if isinstance(state, Holding):
            state = state.before
        return self.behavior.feedback(state, status_flags)

    def can_balance(self, observation: Observation) -> bool:
        """True if the behavior has a leg to balance on.

        Balance needs hip and ankle pitch of the same leg: the hip keeps the trunk
        upright, the ankle moves the center of pressure. Sideways a stance on two feet
        is stable under the user's control too.
        """
        left_over = (1.0 - observation.k[self._pitch]) * self._limit
        return any(min(leg) >= self._least_effort for leg in left_over.tolist())
