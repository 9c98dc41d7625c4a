"""Heights of the center of mass at which the legs reach their footholds.

Geometry of hip, knee and ankle only; the caller chooses the footholds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.robot import Leg

DEEPEST_SQUAT = 0.40
"""Range below the highest position in which the lowest is searched [m]."""
HALVINGS = 9
"""Halvings of that range: the result is exact to a millimetre."""


def leg_length(leg: Leg, knee: float) -> float:
    """Computes the distance from hip to ankle [m] for a knee angle ``knee`` [rad]."""
    a, b = leg.thigh_length, leg.shank_length
    return math.sqrt(a * a + b * b + 2.0 * a * b * math.cos(knee - leg.straight))


def knee_for_length(leg: Leg, length: float) -> float:
    """Computes the bent knee joint's position [rad] for a distance hip to ankle [m]."""
    a, b = leg.thigh_length, leg.shank_length
    cosine = (length * length - a * a - b * b) / (2.0 * a * b)
    return leg.straight + math.acos(min(max(cosine, -1.0), 1.0))


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

    Args:
        legs: Left and right leg.
        hips: Positions of the hips from the center of mass, in W [m], shape (2, 3).
        com: Center of mass, horizontal in W [m], shape (2,).
        footholds: Indices of the feet, with the poses that their soles have to reach.
    """
    heights = []
    for foot, pose in footholds:
        leg = legs[foot]
        longest = leg_length(leg, leg.straight + leg.least_flexion)
        ankle = pose.p_WF + pose.R_WF @ leg.p_FA
        aside = com + hips[foot, :2] - ankle[:2]
        rise = math.sqrt(max(longest * longest - float(aside @ aside), 0.0))
        heights.append(float(ankle[2]) + rise - float(hips[foot, 2]))
    return min(heights)


def highest_sole(
    legs: Sequence[Leg], hips: np.ndarray, height: float, foot: int
) -> float:
    """Computes the height in W [m] to which a folding leg can lift its level sole.

    Args:
        legs: Left and right leg.
        hips: Positions of the hips from the center of mass, in W [m], shape (2, 3).
        height: Height of the center of mass in W [m].
        foot: Index of the lifted foot.
    """
    leg = legs[foot]
    folded = leg_length(leg, leg.straight + leg.most_flexion)
    ankle = float(height + hips[foot, 2]) - folded
    return ankle - float(leg.p_FA[2])


def lowest_com(
    legs: Sequence[Leg],
    hips: np.ndarray,
    com: np.ndarray,
    foot: int,
    pose: FootPose,
    lever: float,
) -> float:
    """Computes the least height of the CoM in W [m] that the standing knee can carry.

    Args:
        legs: Left and right leg.
        hips: Positions of the hips from the center of mass, in W [m], shape (2, 3).
        com: Center of mass, horizontal in W [m], shape (2,).
        foot: Index of the foot that carries the robot alone.
        pose: Pose of the sole of that foot.
        lever: Greatest distance of the knee ahead of the center of mass [m].
    """
    high = highest_com(legs, hips, com, [(foot, pose)])
    low = high - DEEPEST_SQUAT
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _knee_ahead(legs[foot], hips[foot], np.append(com, middle), pose) > lever:
            low = middle
        else:
            high = middle
    return high


def _knee_ahead(leg: Leg, hip: np.ndarray, com: np.ndarray, pose: FootPose) -> float:
    """Distance of the standing leg's knee ahead of the center of mass [m]."""
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
