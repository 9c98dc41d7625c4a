"""Toe-off: the motion of a foot that raises its heel and stands on its toes.

Geometry of the sole and its motion. The behavior decides when a heel rises.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.feet.sole import sole_corners
from atlas_drake.control.feet.swing_foot import SwingReference
from atlas_drake.control.rotations import rotation_y

TOES = 0.03
"""Length of the strip at the front of a sole that carries a foot on its toes [m]."""


def on_toes(flat: FootPose, angle: float, half_length: float) -> FootPose:
    """Computes the pose of a sole with its heel raised.

    Args:
        flat: Pose of the flat sole.
        angle: Pitch of the sole about its toes [rad].
        half_length: Half the length of the sole [m].
    """
    toes = flat.p_WF + half_length * flat.R_WF[:, 0]
    R_WF = flat.R_WF @ rotation_y(angle)
    return FootPose(toes - half_length * R_WF[:, 0], R_WF)


def toe_off_reference(
    flat: FootPose, angle: float, rate: float, acceleration: float, half_length: float
) -> SwingReference:
    """Computes the motion of a sole about its toes from the angle [rad] over time."""
    pose = on_toes(flat, angle, half_length)
    y, arm = flat.R_WF[:, 1], -half_length * pose.R_WF[:, 0]
    return SwingReference(
        p_WF=pose.p_WF,
        v_WF=rate * np.cross(y, arm),
        a_WF=acceleration * np.cross(y, arm) - rate * rate * arm,
        R_WF=pose.R_WF,
        w_WF=rate * y,
        alpha_WF=acceleration * y,
    )


def toe_corners(flat: FootPose, half_length: float, half_width: float) -> np.ndarray:
    """Computes the corners of the strip that carries the toes, in W [m], (4, 3)."""
    middle = flat.p_WF + (half_length - 0.5 * TOES) * flat.R_WF[:, 0]
    return sole_corners(middle, flat.R_WF, 0.5 * TOES, half_width)
