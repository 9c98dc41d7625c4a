"""The part of a sole that carries when the rest is over an edge.

A sole that tips turns about the edge below it, where its points do not move up or down;
what moves down has no ground below. After Wiedebach, Bertrand, Wu, Fiorio, McCrory,
Griffin, Nori, Pratt, "Walking on partial footholds including line contacts with the
humanoid robot Atlas", Humanoids 2016, who find the edge from the foot's turn as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative, ProperShare
from atlas_drake.messages.controller_status import MAX_CORNERS
from atlas_drake.units import Meters, Radians, RadiansPerSecond


@dataclass(frozen=True)
class TippingRules(Configuration):
    """When a sole on the ground tips over an edge."""

    tilt: NotNegative[Radians] = 0.05
    """Tilt from how the sole rested, from which it tips if the tilt grows."""
    rate: NotNegative[RadiansPerSecond] = 0.3
    """Least angular velocity of that."""
    margin: NotNegative[Meters] = 0.01
    """Distance of the carrying part from the edge."""
    least_part: ProperShare = 0.15
    """Least share of the sole's area that can carry: with less the sole is left to
    tip."""


def carrying_part(
    corners: np.ndarray,
    R_WF: np.ndarray,
    V_WF: np.ndarray,
    rest: np.ndarray,
    rules: TippingRules,
) -> np.ndarray | None:
    """Computes the corners of the part that carries in F [m], counterclockwise, (k, 2).

    Args:
        corners: Of the part that has carried so far, likewise, or of the sole.
        R_WF: Orientation of the sole.
        V_WF: Spatial velocity of its center [rad/s; m/s].
        rest: Normal of the sole when it rested, in W.
        rules: When a sole tips.

    Returns:
        None for a sole that does not tip, or has no part that could carry.
    """
    x, y, _ = (R_WF.T @ rest).tolist()
    # The turn from rest, of a small angle: R_WFᵀ n = n - θ × n.
    turn_x, turn_y = y, -x
    wx, wy, _ = (R_WF.T @ V_WF[:3]).tolist()
    rate = math.hypot(wx, wy)
    if (
        math.hypot(turn_x, turn_y) < rules.tilt
        or rate < rules.rate
        or turn_x * wx + turn_y * wy <= 0.0
    ):
        return None
    # Height rate of the point r of the sole: v + ωx r_y - ωy r_x.
    v = float(R_WF[:, 2] @ V_WF[3:])
    inward = np.array([-wy, wx]) / rate
    part = _clipped(corners, inward, rules.margin - v / rate)
    if part is None or len(part) > MAX_CORNERS:
        return None
    return part if _area(part) >= rules.least_part * _area(corners) else None


def _clipped(
    corners: np.ndarray, inward: np.ndarray, least: float
) -> np.ndarray | None:
    """Cuts off a convex polygon where ``inward · r < least``."""
    inside = corners @ inward - least
    if (inside >= 0.0).all():
        return None
    kept = []
    for k, here in enumerate(inside):
        before = inside[k - 1]
        if (here >= 0.0) != (before >= 0.0):
            share = before / (before - here)
            kept.append(corners[k - 1] + share * (corners[k] - corners[k - 1]))
        if here >= 0.0:
            kept.append(corners[k])
    return np.array(kept) if len(kept) > 2 else None


def _area(corners: np.ndarray) -> float:
    x, y = corners.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
