"""Shifts the next footstep when the ankles alone cannot keep balance.

In single support the DCM error grows as e^{ωt}. A shift of the center of pressure
within the stance sole corrects what it can until touchdown; a shift of the next
footstep corrects the rest. The idea of stepping to a shifted DCM follows Khadiv,
Herzog, Moosavian, Righetti, "Walking control based on step timing adaptation", T-RO
2020. This module computes the shift only; it reads no sensors and commands no foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.configuration import Configuration, NotNegative
from atlas_drake.control.feet.footstep import FootPose


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
