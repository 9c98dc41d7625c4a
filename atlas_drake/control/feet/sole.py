"""The rectangle of a sole. Regions for the CoP are in ``support_polygon``."""

from __future__ import annotations

import numpy as np


def sole_corners(
    p_WF: np.ndarray, R_WF: np.ndarray, half_length: float, half_width: float
) -> np.ndarray:
    """Computes the corners of a rectangle about a sole's center in W [m], (4, 3)."""
    corners = np.array(
        [
            [half_length, half_width, 0.0],
            [half_length, -half_width, 0.0],
            [-half_length, -half_width, 0.0],
            [-half_length, half_width, 0.0],
        ]
    )
    return p_WF + corners @ R_WF.T
