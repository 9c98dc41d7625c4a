"""Moves the place of the next footstep when the ankles alone cannot save balance.

In single support the DCM error grows as e^{ωt}. A shift of the center of pressure
within the stance sole takes up what it can until touchdown; the rest is taken up by
the place of the next foot. The idea of stepping to a shifted DCM follows Khadiv,
Herzog, Moosavian, Righetti, "Walking control based on step timing adaptation", T-RO
2020. Reads no sensors and moves no foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.feet.footstep import FootPose


@dataclass(frozen=True)
class StepAdjustmentLimits:
    """How much of the error is left to the ankles and to double support.

    How far a step can be moved is for the limits of steps to say.
    """

    cop_forward: float = 0.10
    """Shift of the CoP that the stance foot can hold along the sole [m]."""
    cop_sideways: float = 0.035
    """Likewise across the sole [m]."""
    tolerated_forward: float = 0.05
    """DCM error at touchdown that double support will take up, along the sole [m]."""
    tolerated_sideways: float = 0.02
    """Likewise across the sole [m]."""


def step_shift(
    dcm_error: np.ndarray,
    remaining: float,
    omega: float,
    sensitivity: float,
    stance: FootPose,
    limits: StepAdjustmentLimits,
) -> np.ndarray:
    """Shift of the next landing place that keeps the DCM's plan within reach.

    Args:
        dcm_error: ξ - ξ_ref in W now [m], shape (2,).
        remaining: Time to touchdown [s].
        omega: Natural frequency [1/s].
        sensitivity: How far the planned DCM at touchdown moves per metre that the
            next foot moves [-].
        stance: The foot on the ground.
        limits: What the ankles can do.

    Returns:
        Horizontal shift in W [m], shape (2,), zero for errors that need no step.
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
