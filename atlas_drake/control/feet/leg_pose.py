"""Joint angles of a leg in one pose, and the torques that hold forces at its foot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.rotations import cross_rows


@dataclass(frozen=True)
class LegPose:
    """One leg's joints in one pose; all vectors in the pelvis frame."""

    angles: np.ndarray  # Joint angles [rad], shape (6,)
    axes: np.ndarray  # Unit vectors of the joints' axes, shape (6, 3)
    points: np.ndarray  # A point on each axis [m], shape (6, 3)

    def torques(self, p_PC: np.ndarray, f_P: np.ndarray) -> np.ndarray:
        """Computes the joint torques [N·m], (6,), that hold forces [N] at p_PC [m]."""
        return -(self.axes * cross_rows(p_PC - self.points, f_P)).sum(axis=1)
