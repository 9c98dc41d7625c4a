"""Which poses of the pelvis the legs, their motors and the feet allow.

A static judgement from the legs' closed-form kinematics: it neither solves for the
whole body nor moves anything.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.feet.leg_kinematics import LegPose, solve_leg
from atlas_drake.control.pelvis.pelvis_pose import PelvisPose, Stance
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.robot import KNEE, Leg, Robot

LEGS_COM = 0.5
"""Where the legs' own center of mass lies on the way from ankles to pelvis [-]."""
_BISECTIONS = 10
"""Halvings between what is possible and what is wished: 0.1 % of the way."""
_HEIGHT_SEARCH = 0.01
"""Step down in search of a height that a wide stance allows [m]."""


@dataclass(frozen=True)
class PelvisReserves:
    """What is kept for balance of what the legs, their motors and the feet allow.

    Measured on both robots in simulation: docs/control.md.
    """

    com_margin: float = 0.04
    """Of the center of mass inside the polygon of possible CoPs [m]."""
    joint_margin: float = 0.05
    """Of leg joints from their end stops [rad]."""
    least_flexion: float = 0.12
    """Knees stay bent by this much, counted from the straight leg [rad]."""
    effort_share: float = 0.8
    """Share of a leg joint's effort that standing still may take [-]."""


@dataclass(frozen=True)
class UpperBody:
    """Everything above the legs, as it is held now.

    Attributes:
        p_PU: Its center of mass in the pelvis frame [m], shape (3,).
    """

    p_PU: np.ndarray


class PelvisReach:
    """Judges poses of one robot. Holds constants only."""

    def __init__(self, robot: Robot, reserves: PelvisReserves | None = None):
        """Judges within the range of poses of ``robot``."""
        self.range = robot.file.pelvis_range
        self.reserves = reserves or PelvisReserves()
        self._legs: tuple[Leg, Leg] = robot.legs
        self._weight = robot.mass * GRAVITY
        legs_mass = sum(float(leg.mass_beyond[0]) for leg in self._legs)
        self._legs_share = legs_mass / robot.mass
        margin = self.reserves.joint_margin
        self._lower, self._upper, self._effort = [], [], []
        for leg in self._legs:
            lower = robot.position_lower[leg.joints] + margin
            straightest = leg.straight + self.reserves.least_flexion
            lower[KNEE] = max(lower[KNEE], straightest)
            self._lower.append(lower)
            self._upper.append(robot.position_upper[leg.joints] - margin)
            self._effort.append(
                self.reserves.effort_share * robot.effort_limit[leg.joints]
            )

    def upper_body(self, terms: WholeBodyTerms, stance: Stance) -> UpperBody:
        """How trunk and arms are held at present."""
        share = self._legs_share
        p_WL = LEGS_COM * terms.p_WP + (1.0 - LEGS_COM) * self._ankles(stance)
        p_WU = (terms.com - share * p_WL) / (1.0 - share)
        return UpperBody(terms.R_WP.T @ (p_WU - terms.p_WP))

    def allows(self, pose: PelvisPose, stance: Stance, upper: UpperBody) -> bool:
        """Whether the robot can stand like that."""
        com = stance.com(pose)
        if stance.support.distance_outside(com) > -self.reserves.com_margin:
            return False
        R_WP = stance.R_WP(pose)
        p_WP = self.pelvis_position(pose, stance, upper)
        loads = self._loads(pose, stance)
        # The center of pressure lies on both soles as the center of mass lies
        # between them.
        left, right = stance.feet
        middle = loads[0] * left.p_WF + loads[1] * right.p_WF
        offset = np.append(com - middle[:2], 0.0)
        up_P = R_WP[2]
        for i, (leg, foot) in enumerate(zip(self._legs, stance.feet, strict=True)):
            p_PF = R_WP.T @ (foot.p_WF - p_WP)
            held: LegPose | None = solve_leg(leg, p_PF, R_WP.T @ foot.R_WF)
            if held is None:
                return False
            angles = held.angles
            if (angles < self._lower[i]).any() or (angles > self._upper[i]).any():
                return False
            p_PC = p_PF + R_WP.T @ offset
            # What a link weighs is not carried by the joints above it. It counts as
            # if it lay on the foot.
            forces = loads[i] * self._weight - GRAVITY * leg.mass_beyond
            torques = held.torques(p_PC, forces[:, None] * up_P)
            if (np.abs(torques) > self._effort[i]).any():
                return False
        return True

    def clamp(
        self, wish: PelvisPose, home: PelvisPose, stance: Stance, upper: UpperBody
    ) -> PelvisPose:
        """The pose nearest to ``wish`` that can be stood in.

        Starting from ``home``, its numbers are granted one after the other, each as
        far as those before it allow: height, CoM, yaw, pitch, roll.

        Args:
            wish: Any finite pose.
            home: An ``attainable`` pose.
            stance: Where the feet are.
            upper: How trunk and arms are held.
        """
        wish = self._boxed(wish)
        if self.allows(wish, stance, upper):
            return wish
        granted = home
        for name in ("height", "com_v0", "com_v1", "yaw", "pitch", "roll"):
            granted = self._grant(granted, name, getattr(wish, name), stance, upper)
        return granted

    def attainable(
        self, home: PelvisPose, stance: Stance, upper: UpperBody
    ) -> PelvisPose:
        """``home``, lowered until the legs allow it, as when the feet are far apart.

        ``home`` itself if no height will do.
        """
        height = home.height
        while height >= self.range.height[0]:
            lowered = home._replace(height=height)
            if self.allows(lowered, stance, upper):
                return lowered
            height -= _HEIGHT_SEARCH
        return home

    def _boxed(self, wish: PelvisPose) -> PelvisPose:
        allowed = self.range
        bounds = (
            allowed.height,
            allowed.yaw,
            allowed.pitch,
            allowed.roll,
            allowed.com,
            allowed.com,
        )
        return PelvisPose(
            *(
                min(max(x, low), high)
                for x, (low, high) in zip(wish, bounds, strict=True)
            )
        )

    def _grant(
        self,
        granted: PelvisPose,
        name: str,
        wish: float,
        stance: Stance,
        upper: UpperBody,
    ) -> PelvisPose:
        """``granted`` with one number moved towards ``wish`` as far as can be."""
        best = granted
        begin = getattr(granted, name)
        low, high = 0.0, 1.0
        share = 1.0
        for _ in range(_BISECTIONS):
            trial = granted._replace(**{name: begin + share * (wish - begin)})
            if self.allows(trial, stance, upper):
                best, low = trial, share
                if share == 1.0:
                    break
            else:
                high = share
            share = 0.5 * (low + high)
        return best

    def pelvis_position(
        self, pose: PelvisPose, stance: Stance, upper: UpperBody
    ) -> np.ndarray:
        """Where in W the pelvis is when the center of mass is where ``pose`` says."""
        legs = self._legs_share
        p_PU_W = stance.R_WP(pose) @ upper.p_PU
        ankles = self._ankles(stance)
        known = (1.0 - legs) * p_PU_W + legs * (1.0 - LEGS_COM) * ankles
        place = (stance.com(pose) - known[:2]) / (1.0 - legs + legs * LEGS_COM)
        return np.append(place, stance.middle[2] + pose.height)

    def _ankles(self, stance: Stance) -> np.ndarray:
        """The middle between both ankles in W [m]."""
        left, right = (
            foot.p_WF + foot.R_WF @ leg.p_FA
            for foot, leg in zip(stance.feet, self._legs, strict=True)
        )
        return 0.5 * (left + right)

    def _loads(self, pose: PelvisPose, stance: Stance) -> tuple[float, float]:
        """Shares of the weight on the left and the right foot."""
        apart = float(
            (stance.feet[0].p_WF[:2] - stance.feet[1].p_WF[:2]) @ stance.along
        )
        left = min(max(0.5 + pose.com_v0 / apart, 0.0), 1.0)
        return left, 1.0 - left
