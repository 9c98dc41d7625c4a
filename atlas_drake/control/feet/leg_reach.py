"""How high the centre of mass can be for the legs to reach their footholds.

Geometry of hip, knee and ankle alone; which footholds count, the caller says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.robot import LegLengths

SHORTEST_FLEXION = 0.30
"""Knees stay bent by this much, counted from the straight leg [rad]: near it they
lose their grip on the height."""
FOLDED_FLEXION = 1.9
"""Flexion of the knee, counted from the straight leg, to which a leg folds with its
sole level [rad]: beyond, the ankle comes to its stop and the leg lifts the body."""
DEEPEST_SQUAT = 0.40
"""Range below the highest position in which the lowest is looked for [m]."""
HALVINGS = 9
"""Of that range: it is found to within a millimetre."""


def leg_length(legs: LegLengths, knee: float) -> float:
    """Distance from hip to ankle [m] with the knee joint at ``knee`` [rad]."""
    a, b = legs.thigh, legs.shank
    return math.sqrt(a * a + b * b + 2.0 * a * b * math.cos(knee - legs.straight))


def knee_for_length(legs: LegLengths, length: float) -> float:
    """Position of the bent knee joint [rad] for a distance from hip to ankle [m]."""
    a, b = legs.thigh, legs.shank
    cosine = (length * length - a * a - b * b) / (2.0 * a * b)
    return legs.straight + math.acos(min(max(cosine, -1.0), 1.0))


def hips_from_com(terms: WholeBodyTerms, legs: LegLengths) -> np.ndarray:
    """Where the hips are now, seen from the centre of mass, in W [m], shape (2, 3)."""
    return terms.p_WP + legs.p_PH @ terms.R_WP.T - terms.com


def highest_com(
    legs: LegLengths,
    hips: np.ndarray,
    com: np.ndarray,
    footholds: Iterable[tuple[int, FootPose]],
) -> float:
    """Greatest height of the centre of mass in W [m] with which all legs reach.

    Args:
        legs: Their lengths.
        hips: The hips as seen from the centre of mass, in W [m], shape (2, 3).
        com: Centre of mass, horizontal in W [m], shape (2,).
        footholds: Feet that shall reach, with the poses of their soles.
    """
    longest = leg_length(legs, legs.straight + SHORTEST_FLEXION)
    heights = []
    for foot, pose in footholds:
        ankle = pose.p_WF + pose.R_WF @ legs.p_FA[foot]
        aside = com + hips[foot, :2] - ankle[:2]
        rise = math.sqrt(max(longest * longest - float(aside @ aside), 0.0))
        heights.append(float(ankle[2]) + rise - float(hips[foot, 2]))
    return min(heights)


def highest_sole(legs: LegLengths, hips: np.ndarray, height: float, foot: int) -> float:
    """Height in W [m] to which a leg that folds can lift its sole, kept level.

    Args:
        legs: Their lengths.
        hips: The hips as seen from the centre of mass, in W [m], shape (2, 3).
        height: Of the centre of mass in W [m].
        foot: The one that is lifted.
    """
    folded = leg_length(legs, legs.straight + FOLDED_FLEXION)
    ankle = float(height + hips[foot, 2]) - folded
    return ankle - float(legs.p_FA[foot, 2])


def lowest_com(
    legs: LegLengths,
    hips: np.ndarray,
    com: np.ndarray,
    foot: int,
    pose: FootPose,
    lever: float,
) -> float:
    """Least height of the centre of mass in W [m] that the standing knee can carry.

    Args:
        legs: Their lengths.
        hips: The hips as seen from the centre of mass, in W [m], shape (2, 3).
        com: Centre of mass, horizontal in W [m], shape (2,).
        foot: The one that carries the robot alone.
        pose: Of its sole.
        lever: How far the knee may lie ahead of the centre of mass [m].
    """
    high = highest_com(legs, hips, com, [(foot, pose)])
    low = high - DEEPEST_SQUAT
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _knee_ahead(legs, hips, np.append(com, middle), foot, pose) > lever:
            low = middle
        else:
            high = middle
    return high


def _knee_ahead(
    legs: LegLengths, hips: np.ndarray, com: np.ndarray, foot: int, pose: FootPose
) -> float:
    """How far the knee of a leg that stands lies ahead of the centre of mass [m]."""
    forward = np.array([math.cos(pose.yaw), math.sin(pose.yaw), 0.0])
    ankle = pose.p_WF + pose.R_WF @ legs.p_FA[foot]
    leg = com + hips[foot] - ankle
    length = math.sqrt(leg @ leg)
    along = leg / length
    # The knee lies off the line from ankle to hip, on its front side.
    up = (legs.shank**2 - legs.thigh**2 + length**2) / (2.0 * length)
    off = math.sqrt(max(legs.shank**2 - up**2, 0.0))
    ahead = float(forward @ along)
    front = math.sqrt(1.0 - ahead * ahead)
    return float(forward @ (ankle - com)) + up * ahead + off * front
