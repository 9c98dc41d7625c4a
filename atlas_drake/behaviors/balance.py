"""Turns references of DCM, feet and body into the QP's command.

The one place where behaviours meet the feedback laws of ``control``. It decides
nothing: where to put feet and centre of mass is each behaviour's business.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.feet.sole import sole_corners
from atlas_drake.control.feet.swing_foot import SwingReference
from atlas_drake.control.feet.toe_off import toe_corners
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body.command import (
    FootCommand,
    Pressure,
    WholeBodyCommand,
)
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.robot import Robot

FULL_LOAD = 3.0
"""Largest normal force asked of one sole, in weights of the robot [-]."""


class Balance:
    """Feedback around given references for one robot. Holds constants only."""

    def __init__(self, robot: Robot, gains: ControlGains):
        self.robot = robot
        self.gains = gains
        self.weight = robot.mass * GRAVITY
        legs = robot.limb("l_leg", "r_leg")
        back = robot.limb("back")
        self._joint_weight = np.where(
            legs,
            gains.leg_posture_weight,
            np.where(back, gains.back_posture_weight, gains.arm_posture_weight),
        )
        self._back = np.flatnonzero(back)

    def command(
        self,
        seen: Observation,
        body: BodyReference,
        reference: DcmReference,
        omega: float,
        support: SupportPolygon,
        feet: tuple[FootCommand, FootCommand],
    ) -> WholeBodyCommand:
        """The QP's command that tracks ``reference`` within ``support``."""
        terms, gains = seen.terms, self.gains
        cop = self.wanted_cop(seen, reference, omega, support)
        base = np.array([*cop, terms.com[2] - GRAVITY / (omega * omega)])
        com_acceleration = np.empty(3)
        com_acceleration[:2] = feedback.com_acceleration_for_cop(terms.com, cop, omega)
        com_acceleration[2] = feedback.height_acceleration(
            terms, body.height, body.height_rate, gains.com_height
        )
        turning = np.array([0.0, 0.0, body.yaw_rate])
        if seen.user_held[self._back].any():
            # The user bends the back: the chest goes where the user puts it, and the
            # pelvis must not be tilted to bring it upright.
            chest = np.zeros(3)
        else:
            chest = feedback.orientation_acceleration(
                body.R_WC,
                turning,
                terms.R_WC,
                terms.w_WC,
                gains.orientation,
            )
        return WholeBodyCommand(
            com_acceleration=com_acceleration,
            pendulum_base=base,
            pelvis_angular_acceleration=feedback.orientation_acceleration(
                body.R_WP, turning, terms.R_WP, terms.V_WP[:3], gains.orientation
            ),
            chest_angular_acceleration=chest,
            feet=feet,
            joint_acceleration=self.posture(seen, body),
            joint_weight=self._joint_weight,
        )

    def wanted_cop(
        self,
        seen: Observation,
        reference: DcmReference,
        omega: float,
        support: SupportPolygon,
    ) -> np.ndarray:
        """Computes the CoP within ``support`` that tracks ``reference`` [m], (2,)."""
        error = feedback.dcm(seen.terms, omega) - reference.dcm
        cop = feedback.feedback_cop(error, reference.cop, self.gains.dcm_gain)
        return support.clamp(cop)

    def posture(self, seen: Observation, body: BodyReference) -> np.ndarray:
        """Joint accelerations towards the posture [rad/s²], shape (n,)."""
        gains, terms = self.gains.posture, seen.terms
        return gains.kp * (body.joints - terms.q) - gains.kd * terms.v

    def pressed(self, seen: Observation, foot: int, load: float) -> FootCommand:
        """A new foot, loaded by at least ``load`` weights so that it turns flat."""
        return FootCommand(
            feedback.stance_acceleration(
                seen.terms.feet[foot], self.gains.stance_foot_damping
            ),
            max_normal_force=FULL_LOAD * self.weight,
            min_normal_force=load * self.weight,
            pressure=Pressure.MIDDLE,
        )

    def planted(
        self, seen: Observation, foot: int, max_load: float = FULL_LOAD
    ) -> FootCommand:
        """A foot that stays where it is, loaded by at most ``max_load`` weights."""
        return FootCommand(
            feedback.stance_acceleration(
                seen.terms.feet[foot], self.gains.stance_foot_damping
            ),
            max_normal_force=max_load * self.weight,
        )

    def hanging(self, seen: Observation, foot: int) -> FootCommand:
        """A foot in the air that is to stop moving."""
        return FootCommand(
            feedback.stance_acceleration(
                seen.terms.feet[foot], self.gains.stance_foot_damping
            ),
            max_normal_force=0.0,
        )

    def swinging(
        self, seen: Observation, foot: int, reference: SwingReference
    ) -> FootCommand:
        """A foot in the air that follows ``reference``."""
        gains, terms = self.gains, seen.terms.feet[foot]
        acceleration = np.empty(6)
        acceleration[:3] = reference.alpha_WF + feedback.orientation_acceleration(
            reference.R_WF,
            reference.w_WF,
            terms.R_WF,
            terms.V_WF[:3],
            gains.swing_orientation,
        )
        acceleration[3:] = (
            reference.a_WF
            + gains.swing_position.kp * (reference.p_WF - terms.p_WF)
            + gains.swing_position.kd * (reference.v_WF - terms.V_WF[3:])
        )
        return FootCommand(acceleration, max_normal_force=0.0)

    def toeing_off(
        self, seen: Observation, foot: int, reference: SwingReference, max_load: float
    ) -> FootCommand:
        """A foot on its toes, whose heel follows ``reference``."""
        in_air = self.swinging(seen, foot, reference)
        return FootCommand(
            in_air.acceleration,
            max_normal_force=max_load * self.weight,
            pressure=Pressure.TOES,
        )

    def toes(self, toeing: FootPose) -> SupportPolygon:
        """Where the CoP of a foot on its toes can lie.

        Args:
            toeing: The foot as it lay before its heel rose.
        """
        contact, sole = self.gains.contact, self.robot.file.sole
        half_width = sole.width / 2 - contact.width_margin
        return SupportPolygon(toe_corners(toeing, sole.length / 2, half_width))

    def support_on_toes(self, flat: FootPose, toeing: FootPose) -> SupportPolygon:
        """Where the CoP can lie with one foot flat and the other on its toes.

        Args:
            flat: The foot that stays.
            toeing: The other one, as it lay before its heel rose.
        """
        toes = self.toes(toeing).vertices
        return SupportPolygon(np.concatenate([self._corners(flat)[:, :2], toes]))

    def support(self, *feet: FootPose) -> SupportPolygon:
        """Where the CoP can lie with these feet on the ground."""
        return SupportPolygon(np.concatenate([self._corners(foot) for foot in feet]))

    def _corners(self, foot: FootPose) -> np.ndarray:
        """Corners of the part of a sole that the CoP can lie in, shape (4, 3)."""
        contact, sole = self.gains.contact, self.robot.file.sole
        return sole_corners(
            foot.p_WF,
            foot.R_WF,
            sole.length / 2 - contact.length_margin,
            sole.width / 2 - contact.width_margin,
        )
