"""PD laws that turn a reference of one frame into an acceleration for its task.

Pure functions from reference and measurement. Behaviors choose the active tasks and
their references.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.gains import PdGains
from atlas_drake.control.rotations import rotation_error


def position_acceleration(
    p_WD: np.ndarray,
    v_WD: np.ndarray,
    p_WF: np.ndarray,
    v_WF: np.ndarray,
    gains: PdGains,
) -> np.ndarray:
    """Computes the acceleration of a point F toward the point D in W [m/s²], (3,)."""
    return gains.kp * (p_WD - p_WF) + gains.kd * (v_WD - v_WF)


def orientation_acceleration(
    R_WD: np.ndarray,
    w_WD: np.ndarray,
    R_WF: np.ndarray,
    w_WF: np.ndarray,
    gains: PdGains,
) -> np.ndarray:
    """Computes the angular acceleration of F toward the orientation D in W, (3,)."""
    kp, kd = gains.kp, gains.kd
    # On floats, which costs half as much as arrays of three.
    ex, ey, ez = rotation_error(R_WD, R_WF).tolist()
    dx, dy, dz = w_WD.tolist()
    x, y, z = w_WF.tolist()
    return np.array(
        [kp * ex + kd * (dx - x), kp * ey + kd * (dy - y), kp * ez + kd * (dz - z)]
    )
