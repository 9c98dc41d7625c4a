"""The points of balance that overlays show: CoM, DCM, CoP and the ground below.

Numbers only; the 3D view and the video draw them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from atlas_drake.control.balance.feedback import dcm, pendulum_frequency
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.control.wrenches import center_of_pressure


class BalancePoints(NamedTuple):
    """Points in W [m], shape (3,).

    Attributes:
        ground: Height of the lower sole [m].
        com: Center of mass.
        dcm: Divergent component of motion, on the ground.
        cop: Center of pressure; None without a load on the feet.
    """

    ground: float
    com: np.ndarray
    dcm: np.ndarray
    cop: np.ndarray | None


def balance_points(terms: WholeBodyTerms, wrenches: np.ndarray) -> BalancePoints:
    """Computes the points.

    Args:
        terms: Kinematics of the robot.
        wrenches: Contact wrenches on both soles, see ``RobotSensors``.
    """
    ground = min(float(foot.p_WF[2]) for foot in terms.feet)
    omega = pendulum_frequency(float(terms.com[2]) - ground)
    soles = [foot.p_WF for foot in terms.feet]
    return BalancePoints(
        ground,
        terms.com,
        np.append(dcm(terms, omega), ground),
        center_of_pressure(soles, wrenches),
    )
