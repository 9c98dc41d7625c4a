"""Feedback of the DCM: center of pressure and accelerations.

Pure functions from reference and measurement. The DCM (ξ = c + ċ/ω) is that of
Takenaka, Matsumoto, Yoshiike, "Real time motion generation and control for biped
robot", IROS 2009; its feedback by the center of pressure is that of Englsberger, Ott,
Albu-Schäffer, "Three-dimensional bipedal walking control based on divergent component
of motion", T-RO 2015.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body.terms import FrameTerms, WholeBodyTerms
from atlas_drake.units import GRAVITY

MIN_HEIGHT = 0.1
"""Lower bound of the pendulum's height [m]. Numerical: it keeps the natural frequency
finite for a robot that lies on the ground."""


def pendulum_frequency(height: float) -> float:
    """Natural frequency of the inverted pendulum √(g/z), z its height [m], [1/s]."""
    return math.sqrt(GRAVITY / max(height, MIN_HEIGHT))


def dcm(terms: WholeBodyTerms, omega: float) -> np.ndarray:
    """Divergent component of motion ξ = c + ċ/ω, horizontal [m], shape (2,)."""
    return terms.com[:2] + terms.com_velocity[:2] / omega


def com_acceleration_for_cmp(
    com: np.ndarray, cmp: np.ndarray, omega: float
) -> np.ndarray:
    """Horizontal acceleration of the pendulum on ``cmp``: ω²(c - p) [m/s²]."""
    return omega * omega * (com[:2] - cmp)


def feedback_cmp(
    dcm_error: np.ndarray, cmp_reference: np.ndarray, gain: float
) -> np.ndarray:
    """CMP that drives the DCM's error to zero: p = p_ref + (1 + k)·(ξ - ξ_ref).

    The error then shrinks at the rate k·ω.
    """
    return cmp_reference + (1.0 + gain) * dcm_error


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
