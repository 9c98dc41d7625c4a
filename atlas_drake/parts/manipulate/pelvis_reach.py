"""Feasibility of pelvis poses: limits of the legs, their motors and the feet.

A static check with the kinematics of the legs. Motion between poses is in
``pelvis_pose``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative, Share
from atlas_drake.control.feet.leg_kinematics import leg_solver
from atlas_drake.control.feet.leg_pose import LegPose
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.parts.manipulate.pelvis_pose import PelvisPose, PelvisRange, Stance
from atlas_drake.robot import KNEE, Leg, Robot
from atlas_drake.units import GRAVITY, Meters, Radians

LEGS_COM = 0.5
"""Position of the legs' center of mass on the line from ankles to pelvis [-]: geometry,
nearly the same for all robots."""
_BISECTIONS = 10
"""Halvings between a feasible and a commanded value: exact to 0.1 % of the distance."""
_HEIGHTS = 36
"""Heights below the stand-prep pose at which the search for a wide stance tries the
legs; a centimetre apart for Atlas."""


@dataclass(frozen=True)
class PelvisReserves(Configuration):
    """Reserves for balance within the limits of the legs, their motors and the feet.

    They make up for what a static check leaves out; measured in simulation, see
    docs/control.md.
    """

    com_margin: NotNegative[Meters] = 0.04
    """Distance of the center of mass to the edge of the support polygon."""
    joint_margin: NotNegative[Radians] = 0.05
    """Distance of leg joints to their end stops."""
    least_flexion: NotNegative[Radians] = 0.12
    """Least flexion of the knees, from the straight leg."""
    effort_share: Share = 0.8
    """Greatest share of a leg joint's effort limit for standing still."""


class PelvisReach:
    """Checks poses of one robot. Holds constants only."""

    def __init__(
        self,
        robot: Robot,
        allowed: PelvisRange | None = None,
        reserves: PelvisReserves | None = None,
    ):
        """Takes the limits of legs and motors from ``robot``; defaults for None."""
        self.range = allowed or PelvisRange()
        self.reserves = reserves or PelvisReserves()
        self._legs: tuple[Leg, Leg] = robot.legs
        self._upright = robot.pelvis_height
        self._weight = robot.mass * GRAVITY
        legs_mass = sum(float(leg.distal_mass[0]) for leg in self._legs)
        self._legs_share = legs_mass / robot.mass
        margin = self.reserves.joint_margin
        self._solvers = [leg_solver(leg) for leg in self._legs]
        self._lower, self._upper, self._effort = [], [], []
        for leg in self._legs:
            lower = robot.position_lower[leg.joints] + margin
            upper = robot.position_upper[leg.joints] - margin
            straightest = leg.knee_at(self.reserves.least_flexion)
            if leg.knee_sign > 0.0:
                lower[KNEE] = max(lower[KNEE], straightest)
            else:
                upper[KNEE] = min(upper[KNEE], straightest)
            self._lower.append(lower)
            self._upper.append(upper)
            self._effort.append(
                self.reserves.effort_share * robot.effort_limit[leg.joints]
            )

    def upper_body(self, terms: WholeBodyTerms, stance: Stance) -> np.ndarray:
        """Computes the center of mass of trunk and arms, p_PU [m], shape (3,)."""
        share = self._legs_share
        p_WL = LEGS_COM * terms.p_WP + (1.0 - LEGS_COM) * self._ankles(stance)
        p_WU = (terms.com - share * p_WL) / (1.0 - share)
        return terms.R_WP.T @ (p_WU - terms.p_WP)

    def allows(
        self,
        pose: PelvisPose,
        stance: Stance,
        p_PU: np.ndarray,
        near: list[LegPose | None] | None = None,
    ) -> bool:
        """Returns True if the robot can stand in the pose.

        ``near`` has the legs of a pose nearby, and gets those of this one.
        """
        near = [None, None] if near is None else near
        com = stance.com(pose)
        if stance.support.distance_outside(com) > -self.reserves.com_margin:
            return False
        R_WP = stance.R_WP(pose)
        p_WP = self.pelvis_position(pose, stance, p_PU)
        loads = self._loads(pose, stance)
        # The CoP on each sole has the same relative position as the CoM between the
        # soles.
        left, right = stance.feet
        middle = loads[0] * left.p_WF + loads[1] * right.p_WF
        offset = np.append(com - middle[:2], 0.0)
        up_P = R_WP[2]
        for i, (leg, foot) in enumerate(zip(self._legs, stance.feet, strict=True)):
            p_PF = R_WP.T @ (foot.p_WF - p_WP)
            held = self._solvers[i](p_PF, R_WP.T @ foot.R_WF, near[i])
            if held is None:
                return False
            near[i] = held
            angles = held.angles
            if (angles < self._lower[i]).any() or (angles > self._upper[i]).any():
                return False
            p_PC = p_PF + R_WP.T @ offset
            # The joints above a link do not carry its weight. The weight counts as if
            # it acted on the foot.
            forces = loads[i] * self._weight - GRAVITY * leg.distal_mass
            torques = held.torques(p_PC, forces[:, None] * up_P)
            if (np.abs(torques) > self._effort[i]).any():
                return False
        return True

    def clamp(
        self, goal: PelvisPose, home: PelvisPose, stance: Stance, p_PU: np.ndarray
    ) -> PelvisPose:
        """Returns the feasible pose nearest to ``goal``.

        Starting from ``home``, an ``attainable`` pose, one coordinate after the other
        is moved toward ``goal`` as far as the coordinates before it allow: height, CoM,
        yaw, pitch, roll.
        """
        goal = self.range.clamp(goal, self._upright)
        if self.allows(goal, stance, p_PU):
            return goal
        granted, near = home, list[LegPose | None]([None, None])
        for name in ("height", "com_v0", "com_v1", "yaw", "pitch", "roll"):
            granted = self._grant(
                granted, name, getattr(goal, name), stance, p_PU, near
            )
        return granted

    def attainable(
        self, home: PelvisPose, stance: Stance, p_PU: np.ndarray
    ) -> PelvisPose:
        """Lowers ``home`` until the legs allow it, as when the feet are far apart.

        Returns ``home`` itself if no height is feasible.
        """
        least = self.range.height.least
        for share in range(_HEIGHTS + 1):
            lowered = home._replace(height=home.height + share / _HEIGHTS * least)
            if lowered.height < self._upright + least:
                break
            if self.allows(lowered, stance, p_PU):
                return lowered
        return home

    def _grant(
        self,
        granted: PelvisPose,
        name: str,
        goal: float,
        stance: Stance,
        p_PU: np.ndarray,
        near: list[LegPose | None],
    ) -> PelvisPose:
        """Moves one coordinate of ``granted`` toward ``goal`` as far as is feasible."""
        best = granted
        begin = getattr(granted, name)
        if begin == goal:
            return granted
        low, high = 0.0, 1.0
        share = 1.0
        for _ in range(_BISECTIONS):
            trial = granted._replace(**{name: begin + share * (goal - begin)})
            if self.allows(trial, stance, p_PU, near):
                best, low = trial, share
                if share == 1.0:
                    break
            else:
                high = share
            share = 0.5 * (low + high)
        return best

    def pelvis_position(
        self, pose: PelvisPose, stance: Stance, p_PU: np.ndarray
    ) -> np.ndarray:
        """Computes the pelvis' position in W for the center of mass of ``pose`` [m]."""
        legs = self._legs_share
        p_PU_W = stance.R_WP(pose) @ p_PU
        ankles = self._ankles(stance)
        known = (1.0 - legs) * p_PU_W + legs * (1.0 - LEGS_COM) * ankles
        place = (stance.com(pose) - known[:2]) / (1.0 - legs + legs * LEGS_COM)
        return np.append(place, stance.middle[2] + pose.height)

    def _ankles(self, stance: Stance) -> np.ndarray:
        """Computes the middle between both ankles in W [m]."""
        left, right = (
            foot.p_WF + foot.R_WF @ leg.p_FA
            for foot, leg in zip(stance.feet, self._legs, strict=True)
        )
        return 0.5 * (left + right)

    def _loads(self, pose: PelvisPose, stance: Stance) -> tuple[float, float]:
        """Computes the shares of the weight on the left and the right foot [-]."""
        apart = float(
            (stance.feet[0].p_WF[:2] - stance.feet[1].p_WF[:2]) @ stance.along
        )
        left = min(max(0.5 + pose.com_v0 / apart, 0.0), 1.0)
        return left, 1.0 - left
