"""Feedback of the DCM: center of pressure, accelerations, and the next footstep.

Pure functions from reference and measurement. The DCM (ξ = c + ċ/ω) is that of
Takenaka, Matsumoto, Yoshiike, "Real time motion generation and control for biped
robot", IROS 2009; its feedback by the center of pressure is that of Englsberger, Ott,
Albu-Schäffer, "Three-dimensional bipedal walking control based on divergent component
of motion", T-RO 2015. Stepping to a shifted DCM is after Khadiv, Herzog, Moosavian,
Righetti, "Walking control based on step timing adaptation", T-RO 2020; the timing is
fixed here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.configuration import Configuration, NotNegative
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.control.whole_body.terms import FrameTerms, WholeBodyTerms

LEAST_HEIGHT = 0.3
"""Lower bound of the pendulum's height [m]. Numerical: it keeps the natural frequency
finite for a robot that lies on the ground."""


def pendulum_frequency(height: float) -> float:
    """Natural frequency of the inverted pendulum √(g/z) [1/s].

    Args:
        height: Height z of the center of mass above the ground at the feet [m].
    """
    return math.sqrt(GRAVITY / max(height, LEAST_HEIGHT))


def dcm(terms: WholeBodyTerms, omega: float) -> np.ndarray:
    """Divergent component of motion ξ = c + ċ/ω, horizontal [m], shape (2,)."""
    return terms.com[:2] + terms.com_velocity[:2] / omega


def com_acceleration_for_cop(
    com: np.ndarray, cop: np.ndarray, omega: float
) -> np.ndarray:
    """Horizontal acceleration of the pendulum on ``cop``: ω²(c - p) [m/s²]."""
    return omega * omega * (com[:2] - cop)


def feedback_cop(
    dcm_error: np.ndarray, cop_reference: np.ndarray, gain: float
) -> np.ndarray:
    """CoP that drives the DCM's error to zero: p = p_ref + (1 + k)·(ξ - ξ_ref).

    The error then shrinks at the rate k·ω.
    """
    return cop_reference + (1.0 + gain) * dcm_error


def height_acceleration(
    terms: WholeBodyTerms, height: float, height_rate: float, gains: PdGains
) -> float:
    """Vertical acceleration of the CoM towards ``height`` in W [m/s²]."""
    return gains.kp * (height - terms.com[2]) + gains.kd * (
        height_rate - terms.com_velocity[2]
    )


def stance_acceleration(foot: FrameTerms, damping: float) -> np.ndarray:
    """Spatial acceleration that brings a planted sole to rest, shape (6,)."""
    return -damping * foot.V_WF


@dataclass(frozen=True)
class StepAdjustmentLimits(Configuration):
    """Part of the DCM error that the ankles and double support correct.

    ``StepLimits`` bounds the shift of the step itself.
    """

    cop_forward: NotNegative = 0.10
    """Shift of the CoP that the stance foot can hold along the sole [m]."""
    cop_sideways: NotNegative = 0.035
    """Shift of the CoP that the stance foot can hold across the sole [m]."""
    tolerated_forward: NotNegative = 0.05
    """DCM error at touchdown that double support can correct, along the sole [m]."""
    tolerated_sideways: NotNegative = 0.02
    """DCM error at touchdown that double support can correct, across the sole [m]."""


def step_shift(
    dcm_error: np.ndarray,
    remaining: float,
    omega: float,
    sensitivity: float,
    stance: FootPose,
    limits: StepAdjustmentLimits,
) -> np.ndarray:
    """Computes the shift of the next footstep that keeps the DCM plan feasible.

    In single support the DCM error grows as e^{ωt}. A shift of the center of pressure
    within the stance sole corrects what it can until touchdown; a shift of the next
    footstep corrects the rest.

    Args:
        dcm_error: ξ - ξ_ref in W now [m], shape (2,).
        remaining: Time to touchdown [s].
        omega: Natural frequency [1/s].
        sensitivity: Shift of the planned DCM at touchdown per shift of the next foot
            [-].
        stance: The foot on the ground.
        limits: Part of the error that the ankles and double support correct.

    Returns:
        Horizontal shift in W [m], shape (2,); zero if the error needs no shift.
    """
    c, s = math.cos(stance.yaw), math.sin(stance.yaw)
    x, y = dcm_error.tolist()
    growth = math.exp(omega * remaining)

    def along(error: float, ankle: float, tolerated: float) -> float:
        final = error * growth
        rest = abs(final) - ankle * (growth - 1.0) - tolerated
        return math.copysign(max(rest / sensitivity, 0.0), final)

    forward = along(c * x + s * y, limits.cop_forward, limits.tolerated_forward)
    sideways = along(c * y - s * x, limits.cop_sideways, limits.tolerated_sideways)
    return np.array([c * forward - s * sideways, s * forward + c * sideways])
