"""FREEZE: hold every joint where it is, and keep the feet still.

The safety mode: FREEZE plans no motion and does not balance, so a robot frozen in
mid-stride falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, capture_body
from atlas_drake.config import Configuration, NotNegative, Share
from atlas_drake.control.whole_body.tasks import PostureTask
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.units import PerAngularAccelerationSquared


@dataclass(frozen=True)
class FreezeConfig(Configuration):
    """Parameters of FREEZE."""

    stiffness_weight: NotNegative[PerAngularAccelerationSquared] = 0.1
    """Weight of holding each joint in the QP, equal for all joints. From 0.3 on the
    soles' small motions come back as contact forces at every tick, until the soles
    flutter and slide; at 0.05 the cost of contact forces makes a robot with staggered
    feet sag."""
    contact_force: Share = 0.02
    """A sole that carries this share of the weight counts as on the ground."""


@dataclass(frozen=True)
class FreezeState:
    """State of FREEZE: joint positions to hold [rad], shape (n,)."""

    joints: np.ndarray


class Freeze(BehaviorProtocol):
    """Holds every joint at its position and the feet still."""

    def __init__(self, balance: Balance, config: FreezeConfig | None = None):
        """Takes gains from ``balance``."""
        config = config or FreezeConfig()
        self._balance = balance
        self._min_load = config.contact_force * balance.weight
        self._weight = np.full(balance.robot.num_joints, config.stiffness_weight)

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> FreezeState:
        """Stores the present joint positions."""
        return FreezeState(observation.terms.q.copy())

    def update(
        self,
        state: FreezeState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of holding the joints."""
        # The next behavior starts from the measured pose, not from the stored one.
        body = capture_body(observation.terms)
        joints = np.where(observation.user_held, observation.terms.q, state.joints)
        gains = self._balance.gains.posture
        # False for a force that was not measured yet: the robot is taken to stand.
        hangs = observation.foot_force <= self._min_load
        left, right = (
            self._balance.unloaded(observation, foot)
            if hangs[foot]
            else self._balance.in_contact(observation, foot)
            for foot in (0, 1)
        )
        still = (
            gains.kp * (joints - observation.terms.q) - gains.kd * observation.terms.v
        )
        command = self._balance.on_feet((left, right), PostureTask(still, self._weight))
        return Outcome(state=FreezeState(joints), body=body, command=command)
