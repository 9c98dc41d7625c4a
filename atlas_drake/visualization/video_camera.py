"""A camera that follows the robot from the front and the side.

Pose of the camera only; ``video_stage`` takes the picture.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RotationMatrix

Vector = NDArray[np.float64]

OFFSET_H: Vector = np.array([3.6, -2.6, 0.45])
"""From the target to the lens, in axes H: x is the robot's initial heading [m]."""
TARGET_ABOVE_PELVIS: Vector = np.array([0.0, 0.0, 0.06])
"""Height of the target: the middle of the robot's height, with room for a caption
[m]."""
LAG = 0.5
"""Time constant with which the camera follows [s]: it does not sway with each step."""


def follow(target: Vector | None, p_WP: Vector, elapsed: float) -> Vector:
    """Computes the next target of the camera, in W [m], shape (3,).

    Args:
        target: Last target in W [m]; None at the start.
        p_WP: Position of the pelvis [m].
        elapsed: Time since the last target [s].
    """
    wanted = p_WP + TARGET_ABOVE_PELVIS
    if target is None:
        return wanted
    share: float = -math.expm1(-elapsed / LAG)
    return target + share * (wanted - target)


def camera_pose(target: Vector, yaw: float) -> RigidTransform:
    """Computes the pose of the camera from its target [m] and the yaw of H [rad]."""
    p_TC: Any = RotationMatrix.MakeZRotation(yaw).multiply(OFFSET_H)
    return looking_at(target + p_TC, target)


def looking_at(lens: Vector, target: Vector) -> RigidTransform:
    """Computes the pose of a camera, x right in the picture, y down and z ahead.

    The target [m] must not be straight above or below the lens [m].
    """
    ahead = (target - lens) / np.linalg.norm(target - lens)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes: Any = np.column_stack([right, np.cross(ahead, right), ahead])
    p_WC: Any = lens
    return RigidTransform(RotationMatrix(axes), p_WC)
