"""The plan of a step: a feasible foothold, posture and heel angle.

Everything about a step that is planned once, before its weight shift. Geometry of legs
and the torque of the standing knee; no time and no feedback.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.control.feet.footstep import (
    landing_error,
    resolve_height,
    saturate,
)
from atlas_drake.control.feet.leg_kinematics import (
    highest_com,
    highest_sole,
    hips_from_com,
    knee_for_length,
    leg_length,
    leg_solver,
    lowest_com,
)
from atlas_drake.control.feet.sole_motion import pitched_pose
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.frozen import replace
from atlas_drake.messages import ToeOff
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.parts.step.config import PostureRules
from atlas_drake.rotations import mean_yaw, rotation_y, rotation_z


@dataclass(frozen=True)
class StepPlan:
    """Plan of one step."""

    taken: Footstep  # The step as it can be taken
    com: np.ndarray  # CoM over the stance foot, horizontal in W [m], shape (2,)
    hips: np.ndarray  # Hip positions from the center of mass, in W [m], shape (2, 3)
    lean: float  # Pitch of the trunk [rad]
    heel: float  # Rise of the leaving heel at lift-off [rad]
    height: float  # Height of the center of mass in W, within the reach of the legs [m]
    ceiling: float  # Height in W to which the leaving leg can lift its sole [m]


class StepPlanner:
    """Plans steps of one robot. Holds constants only."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        limits: StepLimits,
        rules: PostureRules,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        robot = balance.robot
        self.legs = robot.legs
        self._solvers = [leg_solver(leg) for leg in self.legs]
        self._ranges = [
            (robot.position_lower[leg.joints], robot.position_upper[leg.joints])
            for leg in self.legs
        ]
        self.half_length = 0.5 * robot.file.sole.length
        self._nominal_height = nominal_height
        # A sideways distance up to this width does not reduce the reach.
        self._easy_width = balance.stance.width
        self._rules = rules
        self.limits = limits
        self._limits = replace(limits, rise=limits.rise + rules.rise_slack)
        knee = self.legs[0].knee
        upright = leg_length(self.legs[0], robot.stand_prep[knee])
        self._nominal_leg = upright - balance.stance.com_drop
        self._lever = float(robot.effort_limit[knee]) / balance.weight

    @property
    def nominal_knee(self) -> float:
        """Angle of the knees at the nominal height, positive if bent [rad]."""
        leg = self.legs[0]
        return leg.knee_sign * knee_for_length(leg, self._nominal_leg)

    def height(self, action: StepAction) -> float:
        """Computes the height of the center of mass above the standing sole [m]."""
        leg = self.legs[0]
        bent = leg_length(leg, leg.knee_sign * action.knee_nominal)
        return self._nominal_height + bent - self._nominal_leg

    def plan(
        self, terms: WholeBodyTerms, feet: tuple[FootPose, FootPose], desired: Footstep
    ) -> StepPlan | None:
        """Plans a step with the least change of posture; None if it is out of reach.

        If necessary the step is shortened. A step to another height is not, because the
        ground at the shorter distance may have another height; its height is not
        changed either.
        """
        foot, rules = desired.foot, self._rules
        stance = feet[1 - foot]
        limits = self._limits
        meant = resolve_height(desired, stance, limits)
        step = saturate(meant, stance, limits)
        rise = abs(float(meant.p_WF[2] - stance.p_WF[2]))
        level = rise < rules.level
        is_astray = landing_error(meant, step.pose) > limits.astray
        if rise > limits.rise or (is_astray and not level):
            return None
        shares = np.linspace(1.0, rules.smallest_share, 15) if level else (1.0,)
        for knee_effort in rules.knee_efforts:
            for share in shares:
                nearer = step if share == 1.0 else self.shortened(step, stance, share)
                for effort in (0.0, 0.25, 0.5, 0.75, 1.0):
                    plan = self.posture(terms, feet, nearer, effort)
                    lever = knee_effort * self._lever
                    if self._affordable(plan, feet, lever):
                        return plan if self._can_shift(plan, feet) else None
        return None

    def posture(
        self,
        terms: WholeBodyTerms,
        feet: tuple[FootPose, FootPose],
        step: Footstep,
        effort: float,
    ) -> StepPlan:
        """Makes the plan with ``effort`` from 0, upright, to 1, the rules' limits."""
        rules, foot = self._rules, step.foot
        stance, other = feet[1 - foot], feet[foot]
        lean = effort * rules.lean
        R_WS = rotation_z(stance.yaw)
        side = np.sign(R_WS[:2, 1] @ (other.p_WF - stance.p_WF)[:2])
        offset = np.array([effort * rules.ahead, step.action.sway_end_dist * side])
        pitch = math.asin(min(max(-float(terms.R_WP[2, 0]), -1.0), 1.0))
        behind = rules.lean_shift * (lean - pitch)
        com = stance.p_WF[:2] + R_WS[:2, :2] @ offset
        hips = hips_from_com(terms, self.legs) - behind * R_WS[:, 0]
        needed = min(
            float(stance.p_WF[2]) + self.height(step.action),
            highest_com(self.legs, hips, com, [(foot, step.pose)]),
        )
        heel = self._heel(hips, com, foot, other, needed, step.action.toe_off)
        leaving = pitched_pose(other, heel, self.half_length)
        height = min(needed, highest_com(self.legs, hips, com, [(foot, leaving)]))
        ceiling = highest_sole(self.legs, hips, height, foot)
        return StepPlan(step, com, hips, lean, heel, height, ceiling)

    def _heel(
        self,
        hips: np.ndarray,
        com: np.ndarray,
        foot: int,
        flat: FootPose,
        needed: float,
        setting: ToeOff,
    ) -> float:
        """Computes the angle of the leaving heel that keeps the body's height [rad]."""
        rules = self._rules
        if setting is ToeOff.DISABLE:
            return 0.0
        least = rules.forced_heel if setting is ToeOff.FORCE_ENABLE else 0.0
        for angle in np.linspace(0.0, rules.steepest_heel, 13):
            pose = pitched_pose(flat, angle, self.half_length)
            if highest_com(self.legs, hips, com, [(foot, pose)]) > needed - rules.drop:
                break
        return max(float(angle), least)

    def _affordable(
        self, plan: StepPlan, feet: tuple[FootPose, FootPose], lever: float
    ) -> bool:
        """True if the standing knee has enough torque at the height of the plan.

        The height allows for the reach of the other leg at lift-off and at landing.
        """
        stance = 1 - plan.taken.foot
        return plan.height >= lowest_com(
            self.legs,
            plan.hips,
            plan.com,
            stance,
            feet[stance],
            lever,
            self._rules.squat,
        )

    def _can_shift(self, plan: StepPlan, feet: tuple[FootPose, FootPose]) -> bool:
        """Returns True if all joints of the legs reach the end of the weight shift.

        With feet far apart and turned toward each other a hip may be at its stop, while
        both legs are long enough.
        """
        R_WP = rotation_z(mean_yaw(feet[0].yaw, feet[1].yaw)) @ rotation_y(plan.lean)
        com = np.append(plan.com, plan.height)
        for foot, leg in enumerate(self.legs):
            sole = feet[foot]
            if foot == plan.taken.foot:
                sole = pitched_pose(sole, plan.heel, self.half_length)
            p_WP = com + plan.hips[foot] - R_WP @ leg.p_PT
            p_PF = R_WP.T @ (sole.p_WF - p_WP)
            held = self._solvers[foot](p_PF, R_WP.T @ sole.R_WF, None)
            if held is None:
                return False
            lower, upper = self._ranges[foot]
            beyond = np.maximum(lower - held.angles, held.angles - upper)
            if beyond.max() > self._rules.joint_slack:
                return False
        return True

    def shortened(self, step: Footstep, stance: FootPose, share: float) -> Footstep:
        """Returns the step moved towards the place beside the stance foot."""
        R_WS = rotation_z(stance.yaw)
        p_SF = R_WS.T @ (step.p_WF - stance.p_WF)
        beside = min(abs(float(p_SF[1])), self._easy_width)
        beside = math.copysign(beside, p_SF[1])
        p_SF = np.array([share * p_SF[0], beside + share * (p_SF[1] - beside), p_SF[2]])
        nearer = replace(step, p_WF=stance.p_WF + R_WS @ p_SF)
        return saturate(nearer, stance, self._limits)
