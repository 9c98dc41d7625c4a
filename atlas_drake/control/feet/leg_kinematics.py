"""Joint angles and joint torques of one leg in closed form.

For legs whose joints are hip z, hip x, hip y, knee y, ankle y, ankle x from the
pelvis down, as on every Atlas. Feasibility of a pose is decided elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.control.rotations import rotation_x, rotation_y, rotation_z
from atlas_drake.robot import Robot

LEGS = ("l_leg", "r_leg")
"""Limbs in the order of foot indices."""
JOINT_AXES = "zxyyyx"
"""Axes of a leg's joints from the pelvis down."""


@dataclass(frozen=True)
class LegChain:
    """One leg; joints from the pelvis down, hip z to ankle x.

    Attributes:
        p_PH: Hip centre, where hip z and hip x meet, in the pelvis frame [m].
        hip: Hip y axis from the hip centre, in the leg's plane (x, z) [m].
        thigh: Knee from the hip y axis at zero angles, likewise [m].
        shank: Ankle from the knee, likewise [m].
        p_FA: Ankle, where its axes meet, in the sole frame [m].
        joints: Indices of the six joints in message order.
        mass_beyond: Of all links beyond each joint [kg], shape (6,).
    """

    p_PH: np.ndarray
    hip: tuple[float, float]
    thigh: tuple[float, float]
    shank: tuple[float, float]
    p_FA: np.ndarray
    joints: np.ndarray
    mass_beyond: np.ndarray


@dataclass(frozen=True)
class LegPose:
    """One leg's joints in one pose; all vectors in the pelvis frame.

    Attributes:
        angles: [rad], shape (6,).
        axes: Unit vectors of the joints' axes, shape (6, 3).
        points: A point on each axis [m], shape (6, 3).
    """

    angles: np.ndarray
    axes: np.ndarray
    points: np.ndarray

    def torques(self, p_PC: np.ndarray, f_P: np.ndarray) -> np.ndarray:
        """Joint torques that hold forces at the sole [N·m], shape (6,).

        Args:
            p_PC: Where the forces act [m].
            f_P: One force [N], shape (3,), or one for each joint, shape (6, 3).
        """
        return -(self.axes * np.cross(p_PC - self.points, f_P)).sum(axis=1)


def leg_chains(plant: MultibodyPlant, robot: Robot) -> tuple[LegChain, ...]:
    """Reads the left and the right leg from a finalized plant.

    Raises:
        ValueError: If a leg is built differently.
    """
    return tuple(_leg_chain(plant, robot, foot) for foot in (0, 1))


def _leg_chain(plant: Any, robot: Robot, foot: int) -> LegChain:
    context = plant.CreateDefaultContext()
    pelvis = plant.GetBodyByName(robot.file.pelvis).body_frame()
    joints = np.flatnonzero(robot.limb(LEGS[foot]))
    frames = [
        plant.GetJointByName(robot.joint_names[i]).frame_on_child() for i in joints
    ]
    sole = plant.GetFrameByName(robot.file.feet[foot].sole_frame)
    at_zero = [frame.CalcPose(context, pelvis) for frame in (*frames, sole)]
    p = [pose.translation() for pose in at_zero]
    axes = [plant.GetJointByName(robot.joint_names[i]).revolute_axis() for i in joints]
    expected = [np.eye(3)["xyz".index(axis)] for axis in JOINT_AXES]
    lateral = [p[i][1] - p[0][1] for i in range(6)]
    plain = (
        len(joints) == len(JOINT_AXES)
        and np.allclose(axes, expected)
        and all(np.allclose(pose.rotation().matrix(), np.eye(3)) for pose in at_zero)
        and np.allclose(p[1], p[0])
        and np.allclose(p[5], p[4])
        and np.allclose(lateral, 0.0)
    )
    if not plain:
        raise ValueError(
            f"leg {LEGS[foot]!r} of robot '{robot.name}' is not a chain of joints "
            f"{', '.join(JOINT_AXES)} in one plane"
        )

    def plane(end: int, start: int) -> tuple[float, float]:
        return float(p[end][0] - p[start][0]), float(p[end][2] - p[start][2])

    masses = [
        plant.GetJointByName(robot.joint_names[i]).child_body().get_mass(context)
        for i in joints
    ]
    return LegChain(
        p_PH=p[0],
        hip=plane(2, 1),
        thigh=plane(3, 2),
        shank=plane(4, 3),
        p_FA=p[5] - p[6],
        joints=joints,
        mass_beyond=np.cumsum(masses[::-1])[::-1],
    )


def solve_leg(leg: LegChain, p_PF: np.ndarray, R_PF: np.ndarray) -> LegPose | None:
    """The joints that put the sole where it is, knee bent forward.

    Args:
        leg: Which leg.
        p_PF: Sole in the pelvis frame [m].
        R_PF: Its orientation.

    Returns:
        The pose; None when the leg is too short, or the hip is below the ankle.
    """
    p_PA = p_PF + R_PF @ leg.p_FA
    # Seen from the foot, the hip centre lies in the leg's plane, which ankle x tilts.
    to_hip = R_PF.T @ (leg.p_PH - p_PA)
    if to_hip[2] <= 0.0:
        return None
    ankle_x = math.atan2(to_hip[1], to_hip[2])
    R = R_PF @ rotation_x(-ankle_x)
    hip_x = math.asin(min(max(R[2, 1], -1.0), 1.0))
    hip_z = math.atan2(-R[0, 1], R[1, 1])
    pitch = math.atan2(-R[2, 0], R[2, 2])
    R_PX = rotation_z(hip_z) @ rotation_x(hip_x)
    ankle = R_PX.T @ (p_PA - leg.p_PH)
    x, z = ankle[0] - leg.hip[0], ankle[2] - leg.hip[1]
    thigh, shank = math.hypot(*leg.thigh), math.hypot(*leg.shank)
    cosine = (x * x + z * z - thigh * thigh - shank * shank) / (2.0 * thigh * shank)
    if abs(cosine) > 1.0:
        return None
    # Angles of vectors in the plane grow with rotations about y.
    bent = math.atan2(*leg.thigh) - math.atan2(*leg.shank)
    knee = math.acos(cosine) + math.remainder(bent, math.tau)
    c, s = math.cos(knee), math.sin(knee)
    below = (
        leg.thigh[0] + c * leg.shank[0] + s * leg.shank[1],
        leg.thigh[1] - s * leg.shank[0] + c * leg.shank[1],
    )
    hip_y = math.remainder(math.atan2(x, z) - math.atan2(*below), math.tau)
    ankle_y = math.remainder(pitch - hip_y - knee, math.tau)

    y_axis = R_PX[:, 1]
    p_PT = leg.p_PH + R_PX @ np.array([leg.hip[0], 0.0, leg.hip[1]])
    p_PK = p_PT + R_PX @ rotation_y(hip_y) @ np.array([leg.thigh[0], 0, leg.thigh[1]])
    x_axis = np.array([math.cos(hip_z), math.sin(hip_z), 0.0])
    return LegPose(
        angles=np.array([hip_z, hip_x, hip_y, knee, ankle_y, ankle_x]),
        axes=np.array(
            [[0.0, 0.0, 1.0], x_axis, y_axis, y_axis, y_axis, R[:, 0].tolist()]
        ),
        points=np.array([leg.p_PH, leg.p_PH, p_PT, p_PK, p_PA, p_PA]),
    )
