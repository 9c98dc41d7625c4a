"""Legs: joint angles in closed form, and the heights that legs reach.

Joint limits and effort limits are checked in ``parts.manipulate.pelvis_reach``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from atlas_drake.control.feet.leg_pose import LegPose
from atlas_drake.control.feet.numeric_leg import NumericLeg
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.messages.footstep import FootPose
from atlas_drake.robot import Leg
from atlas_drake.rotations import rotation_x, rotation_y, rotation_z

LegSolver = Callable[[np.ndarray, np.ndarray, LegPose | None], LegPose | None]
"""Returns the pose of a leg for position and orientation of its sole in the pelvis.

The third argument is a pose nearby, or None. Returns None if the leg cannot reach it.
"""


def leg_solver(leg: Leg) -> LegSolver:
    """Returns the inverse kinematics of a leg: in closed form where there is one."""
    if leg.planar is None:
        return NumericLeg(leg).solve
    return lambda p_PF, R_PF, near: solve_leg(leg, p_PF, R_PF)


def solve_leg(leg: Leg, p_PF: np.ndarray, R_PF: np.ndarray) -> LegPose | None:
    """Solves the inverse kinematics of a leg for a pose of the sole, knee bent forward.

    For a leg with a planar layout. Returns None if it is too short, or the hip is below
    the ankle.
    """
    plane = leg.planar
    assert plane is not None
    p_PA = p_PF + R_PF @ leg.p_FA
    # Ankle x tilts the leg's plane to its constant distance from the hip center.
    to_hip = R_PF.T @ (plane.p_PH - p_PA)
    away = math.hypot(to_hip[1], to_hip[2])
    if to_hip[2] <= 0.0 or away <= abs(plane.lateral_offset):
        return None
    ankle_x = math.atan2(to_hip[1], to_hip[2]) + math.asin(plane.lateral_offset / away)
    R = R_PF @ rotation_x(-ankle_x)
    hip_x = math.asin(min(max(R[2, 1], -1.0), 1.0))
    hip_z = math.atan2(-R[0, 1], R[1, 1])
    pitch = math.atan2(-R[2, 0], R[2, 2])
    R_PX = rotation_z(hip_z) @ rotation_x(hip_x)
    ankle = R_PX.T @ (p_PA - plane.p_PH)
    x, z = ankle[0] - plane.hip[0], ankle[2] - plane.hip[1]
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
    p_PT = plane.p_PH + R_PX @ plane.p_HT
    p_PK = p_PT + R_PX @ rotation_y(hip_y) @ np.array([leg.thigh[0], 0, leg.thigh[1]])
    x_axis = np.array([math.cos(hip_z), math.sin(hip_z), 0.0])
    return LegPose(
        angles=np.array([hip_z, hip_x, hip_y, knee, ankle_y, ankle_x]),
        axes=np.array(
            [[0.0, 0.0, 1.0], x_axis, y_axis, y_axis, y_axis, R[:, 0].tolist()]
        ),
        points=np.array([plane.p_PH, plane.p_PH, p_PT, p_PK, p_PA, p_PA]),
    )


HALVINGS = 9
"""Halvings of the range in the search for the lowest position; for Atlas exact to a
millimetre."""


def leg_length(leg: Leg, knee: float) -> float:
    """Computes the distance from hip to ankle [m] for a knee's position [rad]."""
    a, b = leg.thigh_length, leg.shank_length
    return math.sqrt(a * a + b * b + 2.0 * a * b * math.cos(knee - leg.straight))


def knee_for_length(leg: Leg, length: float) -> float:
    """Computes the bent knee joint's position [rad] for a distance hip to ankle [m]."""
    a, b = leg.thigh_length, leg.shank_length
    cosine = (length * length - a * a - b * b) / (2.0 * a * b)
    return leg.knee_at(math.acos(min(max(cosine, -1.0), 1.0)))


def hips_from_com(terms: WholeBodyTerms, legs: Sequence[Leg]) -> np.ndarray:
    """Computes the hips' positions from the center of mass, in W [m], shape (2, 3)."""
    p_PT = np.array([leg.p_PT for leg in legs])
    return terms.p_WP + p_PT @ terms.R_WP.T - terms.com


def highest_com(
    legs: Sequence[Leg],
    hips: np.ndarray,
    com: np.ndarray,
    footholds: Iterable[tuple[int, FootPose]],
) -> float:
    """Computes the greatest height of the CoM in W [m] at which all legs reach.

    ``hips`` are relative to the center of mass, ``com`` is its place in W [m], (2,).
    """
    heights = []
    for foot, pose in footholds:
        leg = legs[foot]
        longest = leg_length(leg, leg.knee_at(leg.least_flexion))
        ankle = pose.p_WF + pose.R_WF @ leg.p_FA
        aside = com + hips[foot, :2] - ankle[:2]
        rise = math.sqrt(max(longest * longest - float(aside @ aside), 0.0))
        heights.append(float(ankle[2]) + rise - float(hips[foot, 2]))
    return min(heights)


def highest_sole(
    legs: Sequence[Leg], hips: np.ndarray, height: float, foot: int
) -> float:
    """Computes the height in W [m] to which a folding leg can lift its level sole.

    ``height`` is that of the center of mass in W [m].
    """
    leg = legs[foot]
    folded = leg_length(leg, leg.knee_at(leg.most_flexion))
    ankle = float(height + hips[foot, 2]) - folded
    return ankle - float(leg.p_FA[2])


def lowest_com(
    legs: Sequence[Leg],
    hips: np.ndarray,
    com: np.ndarray,
    foot: int,
    pose: FootPose,
    lever: float,
    squat: float,
) -> float:
    """Computes the least height of the CoM in W [m] that the standing knee can carry.

    ``lever`` is the greatest distance of the knee ahead of the center of mass,
    ``squat`` the range below the highest position that is searched [m].
    """
    high = highest_com(legs, hips, com, [(foot, pose)])
    low = high - squat
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if knee_ahead(legs[foot], hips[foot], np.append(com, middle), pose) > lever:
            low = middle
        else:
            high = middle
    return high


def knee_ahead(leg: Leg, hip: np.ndarray, com: np.ndarray, pose: FootPose) -> float:
    """Computes how far the standing leg's knee is ahead of the center of mass [m]."""
    forward = np.array([math.cos(pose.yaw), math.sin(pose.yaw), 0.0])
    ankle = pose.p_WF + pose.R_WF @ leg.p_FA
    to_hip = com + hip - ankle
    length = math.sqrt(to_hip @ to_hip)
    along = to_hip / length
    # The knee lies off the line from ankle to hip, on its front side.
    thigh, shank = leg.thigh_length, leg.shank_length
    up = (shank**2 - thigh**2 + length**2) / (2.0 * length)
    off = math.sqrt(max(shank**2 - up**2, 0.0))
    ahead = float(forward @ along)
    front = math.sqrt(1.0 - ahead * ahead)
    return float(forward @ (ankle - com)) + up * ahead + off * front
