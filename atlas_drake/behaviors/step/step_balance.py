"""Balance of STEP in all phases: references of body, CoM and loads.

``both_feet`` and ``single_support`` have the controls of the phases.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyTarget
from atlas_drake.behaviors.phases import PhaseControl
from atlas_drake.behaviors.step.config import StepRules
from atlas_drake.behaviors.step.phases import StepPhase
from atlas_drake.behaviors.step.plan import StepPlanner
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon, load_share_range
from atlas_drake.control.balance.weight_shift import (
    WeightShift,
    plan_weight_shift,
    sway_duration,
)
from atlas_drake.control.feet.leg_kinematics import highest_com
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.rotations import mean_yaw


@dataclass(frozen=True)
class Reach:
    """Poses that the legs have to reach."""

    height: float  # Height of the center of mass in W, if the legs can reach it [m]
    now: Sequence[FootPose]  # Present poses of the soles; on landing, if in the air
    later: Sequence[tuple[int, FootPose]]  # Foot and pose after the weight shift


class StepBalance:
    """Balance in the phases of STEP. Holds constants only."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        planner: StepPlanner,
        rules: StepRules,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        self.balance = balance
        self.planner = planner
        self.rules = rules
        self._nominal_height = nominal_height

    def omega(self, observation: Observation, feet: tuple[FootPose, ...]) -> float:
        """Computes the natural frequency of the pendulum on ``feet`` [1/s]."""
        ground = sum(float(foot.p_WF[2]) for foot in feet) / len(feet)
        return observation.pendulum_frequency(ground)

    def dcm_outside(
        self, phase: StepPhase, observation: Observation, support: SupportPolygon
    ) -> float:
        """Computes the distance of the DCM outside ``support``, negative inside [m]."""
        omega = self.omega(observation, phase.feet)
        return support.distance_outside(feedback.dcm(observation.terms, omega))

    def shift_to(
        self,
        observation: Observation,
        end: np.ndarray,
        action: StepAction,
        feet: tuple[FootPose, ...],
        support: SupportPolygon,
    ) -> WeightShift:
        """Plans a weight shift to ``end`` from the present state of the robot."""
        omega = self.omega(observation, feet)
        distance = float(np.hypot(*(end - observation.terms.com[:2])))
        least = sway_duration(distance, action.max_body_accel)
        return plan_weight_shift(
            feedback.dcm(observation.terms, omega),
            end,
            max(action.sway_duration, least),
            support,
            self.rules.cop_inside,
            omega,
        )

    def reach_at_rest(self, feet: tuple[FootPose, FootPose]) -> Reach:
        """Returns the reach with the body half-way between the feet."""
        ground = 0.5 * float(feet[0].p_WF[2] + feet[1].p_WF[2])
        return Reach(ground + self._nominal_height, feet, list(enumerate(feet)))

    def height_over(self, stance: FootPose, step: Footstep) -> float:
        """Computes the requested height of the center of mass of a step, in W [m]."""
        return float(stance.p_WF[2]) + self.planner.height(step.action)

    def body_target(self, phase: StepPhase, reach: Reach) -> BodyTarget:
        """Returns trunk and posture at the requested height, or the legs' reach."""
        com = phase.shift.motion(phase.shift_time)[0]
        legs, now = self.planner.legs, reach.now
        highest = min(
            highest_com(legs, phase.hips, com, enumerate(now)),
            highest_com(legs, phase.hips, phase.shift.end, reach.later),
        )
        tilt = np.array([0.0, phase.lean])
        return BodyTarget(
            height=min(reach.height, highest),
            yaw=mean_yaw(now[0].yaw, now[1].yaw),
            joints=self.balance.robot.stand_prep,
            pelvis_tilt=tilt,
            chest_tilt=tilt,
        )

    def is_early(self, phase: StepPhase) -> bool:
        """Returns True in the first part of the weight shift."""
        return phase.shift_time / phase.shift.duration < self.rules.fresh_share

    def load_range(
        self, phase: StepPhase, foot: int, cop: np.ndarray, on_toes: bool = False
    ) -> tuple[float, float]:
        """Computes the loads that ``foot`` can carry for a CoP, in weights [-]."""
        balance, other = self.balance, phase.feet[foot]
        return load_share_range(
            cop,
            balance.support(phase.feet[1 - foot]),
            balance.toes(other) if on_toes else balance.support(other),
        )

    def with_stance(
        self, observation: Observation, foot: int, command: FootCommand
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot``, and the other foot to stay planted."""
        other = self.balance.in_contact(observation, 1 - foot)
        return (command, other) if foot == 0 else (other, command)

    def touchdown(
        self,
        phase: StepPhase,
        observation: Observation,
        foot: int,
        cop: np.ndarray,
        on_toes: bool = False,
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot`` to be pressed flat, within the load that balance allows."""
        most = self.load_range(phase, foot, cop, on_toes)[1]
        load = min(self.rules.settling_load, most)
        command = self.balance.touchdown(observation, foot, load)
        return self.with_stance(observation, foot, command)


P = TypeVar("P", bound=StepPhase)


class StepPhaseControl(PhaseControl[P]):
    """Computes the ticks of a phase of STEP and its end. Holds constants only.

    Balance has priority over the loads of a phase: a foot with too large or too small a
    load would keep the CoP away from its desired position.
    """

    def __init__(self, balance: StepBalance):
        self._balance = balance

    @abstractmethod
    def reach(self, phase: P) -> Reach:
        """Returns the sole poses that the legs have to reach, and the body's height."""

    def reference(
        self, phase: P, observation: Observation
    ) -> tuple[DcmReference, float]:
        """Computes the references of DCM and CoP, and the pendulum's frequency."""
        omega = self._balance.omega(observation, phase.carrying)
        return phase.dcm_reference(omega), omega

    def cop(self, phase: P, observation: Observation) -> np.ndarray:
        """Computes the desired CoP in W [m], shape (2,)."""
        reference, omega = self.reference(phase, observation)
        support = self.support(phase)
        return self._balance.balance.desired_cop(observation, reference, omega, support)

    def support(self, phase: P) -> SupportPolygon:
        """Returns the present region of the CoP."""
        return phase.support

    def are_both_flat(self, phase: P) -> bool:
        """Returns True if both soles are flat on the ground."""
        return True
