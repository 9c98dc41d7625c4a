"""STAND and STAND_PREP: balance on both feet.

STAND keeps the center of mass over the middle of the feet and brings trunk and arms
to the stand-prep posture. STAND_PREP is the same law, entered without conditions:
it brings the robot to where STAND may begin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation, Outcome
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
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasSimInterfaceCommand, AtlasSimInterfaceState
from atlas_drake.messages.controller_status import Plan

_UPRIGHT = np.zeros(2)


@dataclass(frozen=True)
class StandMemory:
    """Where the robot stands.

    Attributes:
        feet: Left and right sole as noted.
        support: Where the CoP may lie on them.
        middle: Between them in W [m], shape (3,).
        yaw: Their mean heading [rad].
        com: Reference of the center of mass, horizontal in W [m], shape (2,).
        height: Of the center of mass in W, as the legs reach [m].
    """

    feet: tuple[FootPose, FootPose]
    support: SupportPolygon
    middle: np.ndarray
    yaw: float
    com: np.ndarray
    height: float


class Stand:
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
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
    ) -> StandMemory:
        """Starts from where the DCM is, so that nothing moves abruptly."""
        memory = self._note_feet(seen, com=np.zeros(2))
        omega = _pendulum_frequency(seen, memory)
        com = memory.support.clamp(feedback.dcm(seen.terms, omega))
        return replace(memory, com=com)

    def update(
        self,
        memory: StandMemory,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
        leaving: bool,
    ) -> Outcome:
        """One tick of standing.

        It is over as soon as it is to be left; a behavior that is derived from it may
        take its time.
        """
        com = _towards(memory.com, memory.middle, self._config.com_speed * seen.dt)
        if self._slipped(memory, seen):
            memory = self._note_feet(seen, com)
        elif com is not memory.com:
            memory = replace(memory, com=com)
        body = advance_body(
            body,
            self.target(memory, seen, request, leaving),
            self._rates,
            seen.dt,
            seen.terms.q,
            seen.user_held,
        )
        command = self._balance.command(
            seen,
            body,
            DcmReference(dcm=com, cop=com),
            _pendulum_frequency(seen, memory),
            memory.support,
            (self._balance.planted(seen, 0), self._balance.planted(seen, 1)),
        )
        return Outcome(memory=memory, body=body, command=command, finished=leaving)

    def target(
        self,
        memory: StandMemory,
        seen: Observation,
        request: AtlasSimInterfaceCommand,
        leaving: bool,
    ) -> BodyTarget:
        """Where trunk and posture go: upright, in the stand-prep pose.

        Args:
            memory: Where the robot stands.
            seen: What is seen in this tick.
            request: The command in force.
            leaving: Whether another behavior is to follow.
        """
        return BodyTarget(
            height=memory.height,
            yaw=memory.yaw,
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=_UPRIGHT,
        )

    def idle(self, memory: StandMemory, seen: Observation) -> StandMemory:
        """Nothing moves on while the pose is held."""
        return memory

    def resume(
        self,
        memory: StandMemory,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
    ) -> StandMemory:
        """Begins anew: the feet may have moved."""
        return self.enter(seen, body, request)

    def plan(self, memory: StandMemory, com: np.ndarray, omega: float) -> Plan:
        """The reference of the center of mass, where DCM and CoP shall rest, too."""
        return Plan(
            support=memory.support.vertices,
            omega=omega,
            com_reference=memory.com,
            dcm_reference=memory.com,
            cop_reference=memory.com,
        )

    def report(self, memory: StandMemory, state: AtlasSimInterfaceState) -> None:
        """There is nothing to report beyond the behavior's name."""

    def _note_feet(self, seen: Observation, com: np.ndarray) -> StandMemory:
        left, right = seen.foot_pose(0), seen.foot_pose(1)
        middle = 0.5 * (left.p_WF + right.p_WF)
        legs = self._balance.robot.legs
        # With one foot high up the other leg may be too short for the full height.
        reach = highest_com(
            legs, hips_from_com(seen.terms, legs), middle[:2], enumerate((left, right))
        )
        return StandMemory(
            feet=(left, right),
            support=self._balance.support(left, right),
            middle=middle,
            height=min(float(middle[2]) + self._nominal_height, reach),
            yaw=mean_yaw(left.yaw, right.yaw),
            com=com,
        )

    def _slipped(self, memory: StandMemory, seen: Observation) -> bool:
        slip = self._config.foot_slip
        return any(
            abs(x - noted_x) > slip
            for noted, now in zip(memory.feet, seen.terms.feet, strict=True)
            for x, noted_x in zip(now.p_WF.tolist(), noted.p_WF.tolist(), strict=True)
        )


def _pendulum_frequency(seen: Observation, memory: StandMemory) -> float:
    """Of the pendulum on both feet [1/s]."""
    return feedback.pendulum_frequency(float(seen.terms.com[2] - memory.middle[2]))


def _towards(value: np.ndarray, goal: np.ndarray, step: float) -> np.ndarray:
    """``value`` moved by at most ``step`` [m] to ``goal``; itself once it is there."""
    x, y = float(goal[0] - value[0]), float(goal[1] - value[1])
    distance = math.hypot(x, y)
    if distance == 0.0:
        return value
    share = min(step / distance, 1.0)
    return goal[:2].copy() if share == 1.0 else value + np.array([x, y]) * share
