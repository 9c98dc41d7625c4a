"""STAND and STAND_PREP: balance on both feet.

STAND keeps the centre of mass over the middle of the feet and brings trunk and arms
to the stand-prep posture. STAND_PREP is the same law, entered without conditions:
it brings the robot to where STAND may begin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation, Outcome
from atlas_drake.behaviors.body_reference import (
    BodyRates,
    BodyReference,
    BodyTarget,
    advance_body,
)
from atlas_drake.control import tasks
from atlas_drake.control.dcm_plan import DcmReference
from atlas_drake.control.footstep import FootPose
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.control.support_polygon import SupportPolygon
from atlas_drake.messages import AtlasSimInterfaceCommand, AtlasSimInterfaceState

COM_SPEED = 0.08
"""How fast the reference of the centre of mass moves to the feet's middle [m/s]."""
FOOT_SLIP = 0.01
"""A sole that moved this far since it was noted is noted anew [m]."""
_UPRIGHT = np.zeros(2)


@dataclass(frozen=True)
class StandMemory:
    """Where the robot stands.

    Attributes:
        feet: Left and right sole as noted.
        support: Where the CoP may lie on them.
        com: Reference of the centre of mass, horizontal in W [m], shape (2,).
    """

    feet: tuple[FootPose, FootPose]
    support: SupportPolygon
    com: np.ndarray


class Stand:
    """Static balance on both feet."""

    def __init__(self, balance: Balance, nominal_height: float, rates: BodyRates):
        """Stands with the centre of mass ``nominal_height`` [m] above the soles."""
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
        feet = (seen.foot_pose(0), seen.foot_pose(1))
        support = self._balance.support(*feet)
        omega = tasks.pendulum_frequency(self._height_above(seen, feet))
        return StandMemory(feet, support, support.clamp(tasks.dcm(seen.terms, omega)))

    def update(
        self,
        memory: StandMemory,
        seen: Observation,
        body: BodyReference,
        request: AtlasSimInterfaceCommand,
        leaving: bool,
    ) -> Outcome:
        """One tick of standing."""
        memory = self._notice_slip(memory, seen)
        left, right = memory.feet
        middle = 0.5 * (left.p_WF + right.p_WF)
        to_middle = middle[:2] - memory.com
        distance = float(np.hypot(*to_middle))
        step = COM_SPEED * seen.dt
        com = middle[:2] if distance <= step else memory.com + to_middle * (
            step / distance
        )
        memory = replace(memory, com=com)
        body = advance_body(
            body,
            BodyTarget(
                height=float(middle[2]) + self._nominal_height,
                yaw=mean_yaw(left.yaw, right.yaw),
                joints=self._balance.robot.stand_prep,
                pelvis_tilt=_UPRIGHT,
            ),
            self._rates,
            seen.dt,
            seen.terms.q,
            seen.user_held,
        )
        omega = tasks.pendulum_frequency(self._height_above(seen, memory.feet))
        command = self._balance.command(
            seen,
            body,
            DcmReference(dcm=com, cop=com),
            omega,
            memory.support,
            (self._balance.planted(seen, 0), self._balance.planted(seen, 1)),
        )
        return Outcome(memory=memory, body=body, command=command)

    def report(self, memory: StandMemory, state: AtlasSimInterfaceState) -> None:
        """There is nothing to report beyond the behaviour's name."""

    def _height_above(self, seen: Observation, feet: tuple[FootPose, FootPose]):
        ground = 0.5 * (feet[0].p_WF[2] + feet[1].p_WF[2])
        return max(float(seen.terms.com[2] - ground), 0.3 * self._nominal_height)

    def _notice_slip(self, memory: StandMemory, seen: Observation) -> StandMemory:
        for noted, now in zip(memory.feet, seen.terms.feet, strict=True):
            if np.abs(noted.p_WF - now.p_WF).max() > FOOT_SLIP:
                feet = (seen.foot_pose(0), seen.foot_pose(1))
                return replace(
                    memory, feet=feet, support=self._balance.support(*feet)
                )
        return memory
