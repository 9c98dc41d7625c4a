"""FREEZE: hold every joint where it is, and keep the feet still.

The safety mode: it plans nothing and moves nothing. It holds what the ground lets it
hold; a robot frozen in mid-stride falls as a statue would.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, capture_body
from atlas_drake.bounds import Share
from atlas_drake.control.whole_body.tasks import PostureTask
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan


@dataclass(frozen=True)
class FreezeConfig:
    """Tunes FREEZE."""

    stiffness_weight: float = 1.0
    """Weight of holding each joint in the QP, all joints alike [1/(rad/s²)²]."""
    contact_force: Share = 0.02
    """A sole that carries this share of the weight counts as on the ground [-]."""


@dataclass(frozen=True)
class FreezeMemory:
    """Joint positions to hold [rad], shape (n,)."""

    joints: np.ndarray


class Freeze:
    """Holds still."""

    def __init__(self, balance: Balance, config: FreezeConfig | None = None):
        """Takes gains from ``balance``."""
        config = config or FreezeConfig()
        self._balance = balance
        self._least_load = config.contact_force * balance.weight
        self._weight = np.full(balance.robot.num_joints, config.stiffness_weight)

    def enter(
        self,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> FreezeMemory:
        """Notes where the joints are."""
        return FreezeMemory(observation.terms.q.copy())

    def update(
        self,
        memory: FreezeMemory,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """One tick of holding still."""
        # Whoever comes next starts from the pose that is, not from one remembered.
        body = capture_body(observation.terms)
        joints = np.where(observation.user_held, observation.terms.q, memory.joints)
        gains = self._balance.gains.posture
        carrying = observation.foot_force > self._least_load
        left, right = (
            self._balance.planted(observation, foot)
            if carrying[foot]
            else self._balance.hanging(observation, foot)
            for foot in (0, 1)
        )
        still = (
            gains.kp * (joints - observation.terms.q) - gains.kd * observation.terms.v
        )
        command = self._balance.on_feet((left, right), PostureTask(still, self._weight))
        return Outcome(memory=FreezeMemory(joints), body=body, command=command)

    def plan(self, memory: FreezeMemory, com: np.ndarray, omega: float) -> Plan:
        """Nothing is planned: the pose is held."""
        return Plan()

    def report(self, memory: FreezeMemory, state: AtlasSimInterfaceState) -> None:
        """There is nothing to report beyond the behavior's name."""
