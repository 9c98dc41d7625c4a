"""STAND and STAND_PREP: balance on both feet.

STAND keeps the center of mass over the middle of the feet and brings trunk and arms
to the stand-prep posture. STAND_PREP is the same law, entered without conditions: it
brings the robot to a posture from which STAND can begin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import (
    BodyRates,
    BodyReference,
    BodyTarget,
    advance_body,
)
from atlas_drake.behaviors.stand.config import StandConfig
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.feet.leg_reach import highest_com, hips_from_com
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan

_UPRIGHT = read_only(np.zeros(2))


@dataclass(frozen=True)
class StandMemory:
    """State of STAND: latched feet and CoM reference.

    Attributes:
        feet: Latched poses of the left and right sole.
        support: Region of the CoP on the feet.
        middle: Middle between the feet in W [m], shape (3,).
        yaw: Mean heading of the feet [rad].
        com: Reference of the center of mass, horizontal in W [m], shape (2,).
        height: Height of the center of mass in W, within the reach of the legs [m].
    """

    feet: tuple[FootPose, FootPose]
    support: SupportPolygon
    middle: np.ndarray
    yaw: float
    com: np.ndarray
    height: float


class Stand(BehaviorProtocol):
    """Static balance on both feet."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        rates: BodyRates,
        config: StandConfig | None = None,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        self._config = config or StandConfig()
        self._balance = balance
        self._nominal_height = nominal_height
        self._rates = rates

    def enter(
        self,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> StandMemory:
        """Starts from the present DCM, so that the reference does not jump."""
        memory = self._note_feet(observation, com=np.zeros(2))
        omega = _pendulum_frequency(observation, memory)
        com = memory.support.clamp(feedback.dcm(observation.terms, omega))
        return replace(memory, com=com)

    def update(
        self,
        memory: StandMemory,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of standing.

        STAND is finished as soon as ``leaving`` is True; a derived behavior may finish
        later.
        """
        com = _towards(
            memory.com, memory.middle, self._config.com_speed * observation.dt
        )
        if self._slipped(memory, observation):
            memory = self._note_feet(observation, com)
        elif com is not memory.com:
            memory = replace(memory, com=com)
        body = advance_body(
            body,
            self.target(memory, observation, request, leaving),
            self._rates,
            observation.dt,
            observation.terms.q,
            observation.user_held,
        )
        command = self._balance.command(
            observation,
            body,
            DcmReference(dcm=com, cop=com),
            _pendulum_frequency(observation, memory),
            memory.support,
            (
                self._balance.planted(observation, 0),
                self._balance.planted(observation, 1),
            ),
        )
        return Outcome(memory=memory, body=body, command=command, finished=leaving)

    def target(
        self,
        memory: StandMemory,
        observation: Observation,
        request: BehaviorRequest,
        leaving: bool,
    ) -> BodyTarget:
        """Returns the target of trunk and posture: upright, in the stand-prep pose.

        Args:
            memory: State of STAND.
            observation: Observation of this tick.
            request: The command in force.
            leaving: True if another behavior is requested.
        """
        return BodyTarget(
            height=memory.height,
            yaw=memory.yaw,
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=_UPRIGHT,
        )

    def idle(self, memory: StandMemory, observation: Observation) -> StandMemory:
        """Returns the state unchanged: the reference rests while the pose is held."""
        return memory

    def resume(
        self,
        memory: StandMemory,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> StandMemory:
        """Enters STAND again, because the feet may have moved."""
        return self.enter(observation, body, request)

    def plan(self, memory: StandMemory, com: np.ndarray, omega: float) -> Plan:
        """Returns the CoM reference, which is also that of DCM and CoP."""
        return Plan(
            support=memory.support.vertices,
            omega=omega,
            com_reference=memory.com,
            dcm_reference=memory.com,
            cop_reference=memory.com,
        )

    def _note_feet(self, observation: Observation, com: np.ndarray) -> StandMemory:
        left, right = observation.foot_pose(0), observation.foot_pose(1)
        middle = 0.5 * (left.p_WF + right.p_WF)
        legs = self._balance.robot.legs
        # With one foot much higher, the other leg may be too short for the full height.
        reach = highest_com(
            legs,
            hips_from_com(observation.terms, legs),
            middle[:2],
            enumerate((left, right)),
        )
        return StandMemory(
            feet=(left, right),
            support=self._balance.support(left, right),
            middle=middle,
            height=min(float(middle[2]) + self._nominal_height, reach),
            yaw=mean_yaw(left.yaw, right.yaw),
            com=com,
        )

    def _slipped(self, memory: StandMemory, observation: Observation) -> bool:
        slip = self._config.foot_slip
        return any(
            abs(x - noted_x) > slip
            for noted, now in zip(memory.feet, observation.terms.feet, strict=True)
            for x, noted_x in zip(now.p_WF.tolist(), noted.p_WF.tolist(), strict=True)
        )


def _pendulum_frequency(observation: Observation, memory: StandMemory) -> float:
    """Computes the natural frequency of the pendulum on both feet [1/s]."""
    return feedback.pendulum_frequency(
        float(observation.terms.com[2] - memory.middle[2])
    )


def _towards(value: np.ndarray, goal: np.ndarray, step: float) -> np.ndarray:
    """Moves ``value`` by at most ``step`` [m] to ``goal``; at the goal returns it."""
    x, y = float(goal[0] - value[0]), float(goal[1] - value[1])
    distance = math.hypot(x, y)
    if distance == 0.0:
        return value
    share = min(step / distance, 1.0)
    return goal[:2].copy() if share == 1.0 else value + np.array([x, y]) * share
