"""How high the centre of mass can be for the legs to reach their footholds.

Geometry of hip, knee and ankle alone; which footholds count, the caller says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from atlas_drake.control.footstep import FootPose
from atlas_drake.control.whole_body_model import WholeBodyTerms
from atlas_drake.robot import LegGeometry

SHORTEST_FLEXION = 0.30
"""Knees stay bent by this much, counted from the straight leg [rad]: near it they
lose their grip on the height."""


def leg_length(legs: LegGeometry, knee: float) -> float:
    """Distance from hip to ankle [m] with the knee joint at ``knee`` [rad]."""
    a, b = legs.thigh, legs.shank
    return math.sqrt(a * a + b * b + 2.0 * a * b * math.cos(knee - legs.straight))


def knee_for_length(legs: LegGeometry, length: float) -> float:
    """Position of the bent knee joint [rad] for a distance from hip to ankle [m]."""
    a, b = legs.thigh, legs.shank
    cosine = (length * length - a * a - b * b) / (2.0 * a * b)
    return legs.straight + math.acos(min(max(cosine, -1.0), 1.0))


def hips_from_com(terms: WholeBodyTerms, legs: LegGeometry) -> np.ndarray:
    """Where the hips are now, seen from the centre of mass, in W [m], shape (2, 3)."""
    return terms.p_WP + legs.p_PH @ terms.R_WP.T - terms.com


def highest_com(
    legs: LegGeometry,
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
