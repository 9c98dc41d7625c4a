"""Detects a fall from pelvis tilt and height of the center of mass.

The reaction to a fall is in ``supervisor``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from atlas_drake.config import Configuration, NotNegative, Share
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.units import Radians


@dataclass(frozen=True)
class FallLimits(Configuration):
    """Limits of the posture beyond which the robot counts as falling."""

    tilt: NotNegative[Radians] = 1.0
    """Angle of the pelvis' z axis from the vertical."""
    height: Share = 0.6
    """Height of the CoM above the lower sole, relative to the nominal height."""


@dataclass(frozen=True)
class Posture:
    """Quantities from which a fall is detected."""

    upright: float  # Cosine of the angle of the pelvis' z axis from the vertical [-]
    com_height: float  # Height of the CoM above the lower sole [m]


def posture_of(terms: WholeBodyTerms) -> Posture:
    """Computes the posture at a state of the robot."""
    sole = min(float(terms.feet[0].p_WF[2]), float(terms.feet[1].p_WF[2]))
    return Posture(float(terms.R_WP[2, 2]), float(terms.com[2]) - sole)


def sign_of_fall(posture: Posture, nominal_height: float, limits: FallLimits) -> str:
    """Describes the sign of a fall in a posture; empty if the robot does not fall.

    ``nominal_height`` is that of the CoM above the soles when standing [m].
    """
    tilt = math.acos(min(max(posture.upright, -1.0), 1.0))
    if tilt >= limits.tilt:
        return f"pelvis tilted by {tilt:.2f} rad"
    if posture.com_height <= limits.height * nominal_height:
        return f"center of mass only {posture.com_height:.2f} m above the lower sole"
    return ""
