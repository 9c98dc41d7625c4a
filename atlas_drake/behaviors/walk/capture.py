"""Steps that nobody commanded: one that catches the balance, and one beside it.

The capture point of a pendulum on a fixed center of pressure is that of Pratt, Carff,
Drakunov, Goswami, "Capture point: a step toward humanoid push recovery", Humanoids
2006. Pure functions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from atlas_drake.behaviors.walk.timing import GaitTiming
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import outward, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z


def capture_step(
    index: int,
    feet: Sequence[FootPose],
    supports: Sequence[SupportPolygon],
    dcm: np.ndarray,
    omega: float,
    timing: GaitTiming,
    swing_height: float,
    limits: StepLimits,
) -> Footstep:
    """Makes the step to the DCM of its touchdown: ξ_T = r + e^{ωT}(ξ - r).

    The foot that gets nearer to that point steps. The CoP r is the point of the other
    sole that is nearest to the DCM.
    """
    duration = limits.duration.least
    growth = math.exp(omega * timing.swing(duration))

    def step_of(foot: int) -> tuple[float, Footstep]:
        """The step of one foot, and its distance from the point [m]."""
        stance = feet[1 - foot]
        cop = supports[1 - foot].clamp(dcm)
        point = cop + growth * (dcm - cop)
        p_WF = np.append(point, stance.p_WF[2])
        step = Footstep(index, foot, p_WF, stance.yaw, duration, swing_height)
        step = saturate(step, stance, limits)
        return float(np.hypot(*(step.p_WF[:2] - point))), step

    left, right = step_of(LEFT), step_of(RIGHT)
    return left[1] if left[0] <= right[0] else right[1]


def closing_step(
    index: int,
    foot: int,
    other: FootPose,
    width: float,
    duration: float,
    swing_height: float,
) -> Footstep:
    """Makes the step that puts ``foot`` beside the ``other`` one."""
    beside = outward(foot) * width * rotation_z(other.yaw)[:, 1]
    return Footstep(index, foot, other.p_WF + beside, other.yaw, duration, swing_height)
