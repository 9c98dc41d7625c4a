"""What the phases of STEP read in one tick, and the constants of one robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.control.balance import feedback
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.parts.step.config import StepConfig, StepRules
from atlas_drake.parts.step.plan import StepPlanner
from atlas_drake.parts.step.weight_shift import (
    WeightShift,
    plan_weight_shift,
    sway_duration,
)
from atlas_drake.support_polygon import SupportPolygon


class StepTools:
    """The constants of STEP for one robot."""

    def __init__(self, tools: BehaviorTools, config: StepConfig):
        self.balance = tools.balance
        self.config = config
        self.gait = tools.gait
        self.nominal_height = tools.nominal_height
        self.planner = StepPlanner(
            tools.balance, tools.nominal_height, config.limits, config.posture
        )
        usual = {**vars(config.action.usual), "knee_nominal": self.planner.nominal_knee}
        self.usual_action = StepAction(**usual)


@dataclass(frozen=True)
class StepTick:
    """What the phases of STEP read in one tick.

    Attributes:
        observation: State of the robot.
        leaving: True if the end of STEP is requested.
        tools: Constants.
    """

    observation: Observation
    leaving: bool
    tools: StepTools

    @property
    def rules(self) -> StepRules:
        """Thresholds of STEP."""
        return self.tools.config.rules

    @property
    def half_length(self) -> float:
        """Half the length of a sole [m]."""
        return self.tools.planner.half_length

    def omega(self, feet: tuple[FootPose, ...]) -> float:
        """Computes the natural frequency of the pendulum on ``feet`` [1/s]."""
        ground = sum(float(foot.p_WF[2]) for foot in feet) / len(feet)
        return self.observation.pendulum_frequency(ground)

    def dcm(self, feet: tuple[FootPose, ...]) -> np.ndarray:
        """Computes the DCM of the pendulum on ``feet``, in W [m], shape (2,)."""
        return feedback.dcm(self.observation.terms, self.omega(feet))

    def shift_to(
        self,
        end: np.ndarray,
        action: StepAction,
        feet: tuple[FootPose, ...],
        support: SupportPolygon,
    ) -> WeightShift:
        """Plans a weight shift to ``end`` from the present state of the robot."""
        distance = float(np.hypot(*(end - self.observation.terms.com[:2])))
        least = sway_duration(distance, action.max_body_accel)
        return plan_weight_shift(
            self.dcm(feet),
            end,
            max(action.sway_duration, least),
            support,
            self.rules.cop_inside,
            self.omega(feet),
        )

    def height_over(self, stance: FootPose, step: Footstep) -> float:
        """Computes the requested height of the center of mass of a step, in W [m]."""
        return float(stance.p_WF[2]) + self.tools.planner.height(step.action)
