"""The camera of a film: it stands where the world's view says, or follows the robot.

Pose of the camera only; ``stage`` takes the picture.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.records import TickRecord
from atlas_drake.rotations import rotation_matrix, yaw_of
from atlas_drake.worlds.world_file import View

Vector = NDArray[np.float64]

OFFSET_H: Vector = np.array([3.3, -2.4, 0.5])
"""From the target to the lens, in axes H: x is the robot's initial heading [m]."""
TARGET_ABOVE_PELVIS: Vector = np.array([0.0, 0.0, -0.05])
"""Height of the target: near the middle of the robot's height, with room for the steps
ahead [m]."""
LAG = 0.5
"""Time constant with which the camera follows [s]: it does not sway with each step."""


class FilmCamera:
    """Looks at the robot, picture by picture."""

    def __init__(self, view: View | None, period: float) -> None:
        """Looks from ``view``, or follows the robot without one.

        ``period`` is the time between pictures [s].
        """
        self._step = -math.expm1(-period / LAG)
        self._target: Vector | None = None
        self._yaw, self._fixed = 0.0, None
        self.X_TC = looking_at(OFFSET_H, np.zeros(3))
        if view is not None:
            lens, target = np.array(view.lens), np.array(view.target)
            self._fixed = looking_at(lens, target)
            self.X_TC = looking_at(lens - target, np.zeros(3))

    def pose(self, record: TickRecord) -> RigidTransform:
        """Returns the pose of the camera in W for the next picture."""
        if self._fixed is not None:
            return self._fixed
        q = record.state.q
        goal = q[4:7] + TARGET_ABOVE_PELVIS
        if self._target is None:
            q_WB = q[:4] / np.linalg.norm(q[:4])
            self._yaw, self._target = yaw_of(rotation_matrix(q_WB)), goal
        self._target = self._target + self._step * (goal - self._target)
        R_WT = RotationMatrix.MakeZRotation(self._yaw)
        return RigidTransform(R_WT, self._target).multiply(self.X_TC)


def looking_at(lens: Vector, target: Vector) -> RigidTransform:
    """Computes the pose of a camera, x right in the picture, y down and z ahead."""
    ahead = (target - lens) / np.linalg.norm(target - lens)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-6:  # Straight up or down.
        right = np.array([0.0, -1.0, 0.0])
    right /= np.linalg.norm(right)
    axes = np.column_stack([right, np.cross(ahead, right), ahead])
    return RigidTransform(RotationMatrix(axes), lens)
