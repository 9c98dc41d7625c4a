"""Model terms of one control tick, as values, for tasks and behaviors.

Evaluation is in ``model``; this module does not use a plant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


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
    feet: tuple[FrameTerms, FrameTerms]
    frames: dict[str, FrameTerms]
    compute_frame: Callable[[str], FrameTerms]

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
