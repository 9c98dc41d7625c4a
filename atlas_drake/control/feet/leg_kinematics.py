"""Joint angles and joint torques of one leg in closed form.

For the one layout of legs that ``robot.leg`` describes and reads. Joint limits and
effort limits are checked in ``control.pelvis.pelvis_reach``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.rotations import rotation_x, rotation_y, rotation_z
from atlas_drake.robot import Leg


@dataclass(frozen=True)
class LegPose:
    """One leg's joints in one pose; all vectors in the pelvis frame.

    Attributes:
        angles: Joint angles [rad], shape (6,).
        axes: Unit vectors of the joints' axes, shape (6, 3).
        points: A point on each axis [m], shape (6, 3).
    """

    angles: np.ndarray
    axes: np.ndarray
    points: np.ndarray

    def torques(self, p_PC: np.ndarray, f_P: np.ndarray) -> np.ndarray:
        """Computes the joint torques that hold forces at the sole [N·m], shape (6,).

        Args:
            p_PC: Point at which the forces act [m].
            f_P: One force [N], shape (3,), or one force for each joint, shape (6, 3).
        """
        return -(self.axes * np.cross(p_PC - self.points, f_P)).sum(axis=1)


def solve_leg(leg: Leg, p_PF: np.ndarray, R_PF: np.ndarray) -> LegPose | None:
    """Solves the inverse kinematics of a leg for a pose of the sole, knee bent forward.

    Args:
        leg: Which leg.
        p_PF: Position of the sole in the pelvis frame [m].
        R_PF: Orientation of the sole.

    Returns:
        The pose; None if the leg is too short, or the hip is below the ankle.
    """
    p_PA = p_PF + R_PF @ leg.p_FA
    # Ankle x tilts the leg's plane to its constant distance from the hip center.
    to_hip = R_PF.T @ (leg.p_PH - p_PA)
    away = math.hypot(to_hip[1], to_hip[2])
    if to_hip[2] <= 0.0 or away <= abs(leg.aside):
        return None
    ankle_x = math.atan2(to_hip[1], to_hip[2]) + math.asin(leg.aside / away)
    R = R_PF @ rotation_x(-ankle_x)
    hip_x = math.asin(min(max(R[2, 1], -1.0), 1.0))
    hip_z = math.atan2(-R[0, 1], R[1, 1])
    pitch = math.atan2(-R[2, 0], R[2, 2])
    R_PX = rotation_z(hip_z) @ rotation_x(hip_x)
    ankle = R_PX.T @ (p_PA - leg.p_PH)
    x, z = ankle[0] - leg.hip[0], ankle[2] - leg.hip[1]
    thigh, shank = leg.thigh_length, leg.shank_length
    cosine = (x * x + z * z - thigh * thigh - shank * shank) / (2.0 * thigh * shank)
    if abs(cosine) > 1.0:
        return None
    knee = math.acos(cosine) + leg.straight
    c, s = math.cos(knee), math.sin(knee)
    below = (
        leg.thigh[0] + c * leg.shank[0] + s * leg.shank[1],
        leg.thigh[1] - s * leg.shank[0] + c * leg.shank[1],
    )
    # Angles of vectors in the plane grow with rotations about y.
    hip_y = math.remainder(math.atan2(x, z) - math.atan2(*below), math.tau)
    ankle_y = math.remainder(pitch - hip_y - knee, math.tau)

    y_axis = R_PX[:, 1]
    p_PT = leg.p_PH + R_PX @ leg.p_HT
    p_PK = p_PT + R_PX @ rotation_y(hip_y) @ np.array([leg.thigh[0], 0, leg.thigh[1]])
    x_axis = np.array([math.cos(hip_z), math.sin(hip_z), 0.0])
    return LegPose(
        angles=np.array([hip_z, hip_x, hip_y, knee, ankle_y, ankle_x]),
        axes=np.array(
            [[0.0, 0.0, 1.0], x_axis, y_axis, y_axis, y_axis, R[:, 0].tolist()]
        ),
        points=np.array([leg.p_PH, leg.p_PH, p_PT, p_PK, p_PA, p_PA]),
    )
