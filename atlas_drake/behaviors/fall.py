"""How a robot that falls, or lies on the ground, is told from one that stands.

What follows from it is the supervisor's business.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from atlas_drake.control.whole_body.terms import WholeBodyTerms


@dataclass(frozen=True)
class FallLimits:
    """When the robot counts as falling."""

    tilt: float = 0.8
    """Angle of the pelvis' z axis from the vertical [rad]."""
    height: float = 0.6
    """Height of the CoM above the lower sole, as a share of the nominal one [-]."""


def sign_of_fall(
    terms: WholeBodyTerms, nominal_height: float, limits: FallLimits
) -> str:
    """What in a posture is that of a falling robot; empty if nothing is.

    A robot that hangs in the air or lies still is told from one that stands by the
    height of its centre of mass above its own lower sole, not above the world.

    Args:
        terms: At the present state.
        nominal_height: Of the centre of mass above the soles when standing [m].
        limits: From where on it falls.
    """
    tilt = math.acos(min(max(float(terms.R_WP[2, 2]), -1.0), 1.0))
    if tilt >= limits.tilt:
        return f"pelvis tilted by {tilt:.2f} rad"
    sole = min(float(terms.feet[0].p_WF[2]), float(terms.feet[1].p_WF[2]))
    height = float(terms.com[2]) - sole
    if height <= limits.height * nominal_height:
        return f"centre of mass only {height:.2f} m above the lower sole"
    return ""
