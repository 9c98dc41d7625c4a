"""STAND and STAND_PREP: balance on both feet.

STAND keeps the center of mass over the middle of the feet and brings trunk and arms
to the stand-prep posture. STAND_PREP is the same law, entered without conditions: it
brings the robot to a posture from which STAND can begin.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyRates, BodyReference, BodyTarget
from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.leg_kinematics import highest_com, hips_from_com
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import mean_yaw
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import Meters, MetersPerSecond, Ratio


@dataclass(frozen=True)
class StandConfig(Configuration):
    """Parameters of STAND and STAND_PREP."""

    com_speed: NotNegative[MetersPerSecond] = 0.08
    """Speed of the CoM reference towards the middle of the feet."""
    foot_slip: NotNegative[Meters] = 0.01
    """Re-latch the pose of a sole that slipped farther than this."""
    recovery_steps: bool = True
    """Whether STAND and MANIPULATE hand over to WALK for a step when the DCM leaves the
    support polygon. The step is made to the height of the ground below the feet."""
    recovery_margin: NotNegative[Meters] = 0.01
    """Distance of the DCM outside the support polygon from which a step is needed."""
    recovery_load: NotNegative[Ratio] = 0.3
    """Least load on both feet for a step, in weights of the robot: a robot that hangs
    does not step."""


_UPRIGHT = read_only(np.zeros(2))
ARRIVED = 0.01
"""A trunk this near to its target has arrived [rad]."""

Pose: TypeAlias = (
    "Callable[[BodyTarget, Observation, BehaviorRequest, bool], BodyTarget]"
)
"""Changes STAND's target, from (upright, observation, request, leaving)."""


@dataclass(frozen=True)
class StandState:
    """State of STAND: latched feet and CoM reference."""

    feet: tuple[FootPose, FootPose]  # Latched poses of the left and right sole
    support: SupportPolygon  # Region of the CoP on the feet
    middle: np.ndarray  # Middle between the feet in W [m], shape (3,)
    yaw: float  # Mean heading of the feet [rad]
    com: np.ndarray  # Reference of the center of mass, horizontal in W [m], shape (2,)
    height: float  # Height of the center of mass in W, within the reach of the legs [m]


class Stand(BehaviorProtocol):
    """Static balance on both feet."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        rates: BodyRates,
        config: StandConfig | None = None,
        pose: Pose | None = None,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        self._pose = pose
        self._config = config or StandConfig()
        self._balance = balance
        self._nominal_height = nominal_height
        self._rates = rates

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> StandState:
        """Starts from the present DCM, so that the reference does not jump."""
        state = self._note_feet(observation, com=np.zeros(2))
        omega = observation.pendulum_frequency(float(state.middle[2]))
        com = state.support.clamp(feedback.dcm(observation.terms, omega))
        return replace(state, com=com)

    def update(
        self,
        state: StandState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of standing.

        With ``leaving``, STAND is finished at once, and with a changed pose as soon as
        the trunk is at its target.
        """
        com = _towards(state.com, state.middle, self._config.com_speed * observation.dt)
        if observation.has_slipped(state.feet, self._config.foot_slip):
            state = self._note_feet(observation, com)
        elif com is not state.com:
            state = replace(state, com=com)
        target = BodyTarget(
            height=state.height,
            yaw=state.yaw,
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=_UPRIGHT,
            chest_tilt=_UPRIGHT,
        )
        finished = leaving
        if self._pose is not None:
            target = self._pose(target, observation, request, leaving)
            finished = leaving and _has_arrived(body, target)
        body = observation.advance_body(body, target, self._rates)
        command = self._balance.command(
            observation,
            body,
            DcmReference(dcm=com, cop=com),
            observation.pendulum_frequency(float(state.middle[2])),
            state.support,
            self._balance.standing(observation, state.feet),
        )
        return Outcome(state=state, body=body, command=command, finished=finished)

    def plan(self, state: StandState, com: np.ndarray, omega: float) -> Plan:
        """Returns the CoM reference, which is also that of DCM and CoP."""
        return Plan(
            support=state.support.vertices,
            omega=omega,
            com_reference=state.com,
            dcm_reference=state.com,
            cop_reference=state.com,
        )

    def _note_feet(self, observation: Observation, com: np.ndarray) -> StandState:
        left, right = observation.foot_poses
        middle = 0.5 * (left.p_WF + right.p_WF)
        legs = self._balance.robot.legs
        # With one foot much higher, the other leg may be too short for the full height.
        reach = highest_com(
            legs,
            hips_from_com(observation.terms, legs),
            middle[:2],
            enumerate((left, right)),
        )
        return StandState(
            feet=(left, right),
            support=self._balance.support(left, right),
            middle=middle,
            height=min(float(middle[2]) + self._nominal_height, reach),
            yaw=mean_yaw(left.yaw, right.yaw),
            com=com,
        )


def _has_arrived(body: BodyReference, target: BodyTarget) -> bool:
    """Returns True if pelvis and chest are tilted as their target is."""
    pelvis = body.pelvis_tilt - target.pelvis_tilt
    chest = body.chest_tilt - target.chest_tilt
    return float(np.abs([pelvis, chest]).max()) < ARRIVED


def _towards(value: np.ndarray, goal: np.ndarray, step: float) -> np.ndarray:
    """Moves ``value`` by at most ``step`` [m] to ``goal``; at the goal returns it."""
    x, y = float(goal[0] - value[0]), float(goal[1] - value[1])
    distance = math.hypot(x, y)
    if distance == 0.0:
        return value
    share = min(step / distance, 1.0)
    return goal[:2].copy() if share == 1.0 else value + np.array([x, y]) * share
