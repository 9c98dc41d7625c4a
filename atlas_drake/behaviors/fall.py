"""Detects a fall from pelvis tilt and height of the center of mass.

What follows from a fall is not decided here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from atlas_drake.bounds import Share
from atlas_drake.control.whole_body.terms import WholeBodyTerms


@dataclass(frozen=True)
class FallLimits:
    """When the robot counts as falling."""

    tilt: float = 0.8
    """Angle of the pelvis' z axis from the vertical [rad]."""
    height: Share = 0.6
    """Height of the CoM above the lower sole, as a share of the nominal one [-]."""


@dataclass(frozen=True)
class Posture:
    """What a fall shows in.

    Attributes:
        upright: Cosine of the angle between the pelvis' z axis and the vertical [-].
        com_height: Height of the center of mass above the lower sole [m]. It tells a
            robot that lies from one that stands or hangs wherever the ground is.
    """

    upright: float
    com_height: float


def posture_of(terms: WholeBodyTerms) -> Posture:
    """The posture at a state of the robot."""
    sole = min(float(terms.feet[0].p_WF[2]), float(terms.feet[1].p_WF[2]))
    return Posture(float(terms.R_WP[2, 2]), float(terms.com[2]) - sole)


def sign_of_fall(posture: Posture, nominal_height: float, limits: FallLimits) -> str:
    """What in a posture is that of a falling robot; empty if nothing is.

    Args:
        posture: Of the robot now.
        nominal_height: Of the center of mass above the soles when standing [m].
        limits: From where on the robot falls.
    """
    tilt = math.acos(min(max(posture.upright, -1.0), 1.0))
    if tilt >= limits.tilt:
        return f"pelvis tilted by {tilt:.2f} rad"
    if posture.com_height <= limits.height * nominal_height:
        return f"center of mass only {posture.com_height:.2f} m above the lower sole"
    return ""
