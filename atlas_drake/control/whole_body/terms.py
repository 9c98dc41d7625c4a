"""Model terms of one control tick, as values, for tasks and behaviors.

Evaluation is in ``model``; this module does not use a plant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.control.wrenches import shift_wrench
from atlas_drake.units import GRAVITY


class FrameTerms(NamedTuple):
    """Kinematics of one frame F of the robot.

    Generalized velocities are ordered as in ``WholeBodyTerms``; n_v = 6 + n.

    Attributes:
        p_WF: Position of the frame's origin [m], shape (3,).
        R_WF: Orientation, shape (3, 3).
        V_WF: Spatial velocity in W [rad/s; m/s], shape (6,).
        J_WF: Jacobian of V_WF, J ∈ R^{6 × n_v}.
        bias: J̇·v in W [rad/s²; m/s²], shape (6,).
    """

    p_WF: np.ndarray
    R_WF: np.ndarray
    V_WF: np.ndarray
    J_WF: np.ndarray
    bias: np.ndarray


@dataclass(frozen=True)
class WholeBodyTerms:
    """All model terms at one state, read-only; n joints in message order.

    Generalized velocities v ∈ R^{n_v} are [ω_WP, v_WP, joints]: the pelvis' angular
    and translational velocity in W, then the joints; n_v = 6 + n.

    Attributes:
        mass: Total mass [kg].
        q: Joint positions [rad], shape (n,).
        v: Joint velocities [rad/s], shape (n,).
        M: Mass matrix, M ∈ R^{n_v × n_v}.
        h: Coriolis, centrifugal and gravity forces and the damping of the joints
            [N·m; N], shape (n_v,).
        R_WP: Orientation of the pelvis.
        p_WP: Position of the pelvis [m].
        V_WP: Spatial velocity of the pelvis [rad/s; m/s] in W.
        R_WC: Orientation of the chest.
        w_WC: Angular velocity of the chest in W [rad/s].
        com: Center of mass in W [m].
        com_velocity: Velocity of the center of mass in W [m/s].
        pull: Wrench on the hands in W, about its origin [N·m; N], shape (6,), beyond
            the weight of loads that are in ``mass``; a part of ``h``.
        feet: Left and right sole.
        frames: Frames computed so far, by name. Read them with ``frame``.
        compute_frame: Computes a frame of the robot by name.
    """

    mass: float
    q: np.ndarray
    v: np.ndarray
    M: np.ndarray
    h: np.ndarray
    R_WP: np.ndarray
    p_WP: np.ndarray
    V_WP: np.ndarray
    R_WC: np.ndarray
    w_WC: np.ndarray
    com: np.ndarray
    com_velocity: np.ndarray
    pull: np.ndarray
    feet: tuple[FrameTerms, FrameTerms]
    frames: dict[str, FrameTerms]
    compute_frame: Callable[[str], FrameTerms]

    @property
    def pull_offset(self) -> np.ndarray:
        """How far the pull moves the CMP from the CoP [m], shape (2,).

        The CMP p of a constant center of mass is below it, and there m·g·(p - CoP) + M
        = 0 for the moment M of the pull about the ground below.
        """
        if not self.pull.any():
            return np.zeros(2)
        below = self.com.copy()
        below[2] = mean_sole_height(self)
        pull = self.pull.copy()
        shift_wrench(pull, below)
        M_x, M_y, *_ = pull.tolist()
        return np.array([-M_y, M_x]) / (self.mass * GRAVITY)

    def frame(self, name: str) -> FrameTerms:
        """Returns the kinematics of any frame; computed at the first request.

        Args:
            name: Name of a frame or body in the robot's URDF.

        Raises:
            RobotDescriptionError: If the robot has no frame of this name.
        """
        known = self.frames.get(name)
        if known is None:
            known = self.frames[name] = self.compute_frame(name)
        return known


def mean_sole_height(terms: WholeBodyTerms) -> float:
    """Height of the middle between both soles in W [m]."""
    return 0.5 * float(terms.feet[0].p_WF[2] + terms.feet[1].p_WF[2])
