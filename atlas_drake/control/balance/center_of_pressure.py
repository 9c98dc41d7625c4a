"""Where the ground's force acts, from the wrenches on both soles.

What is measured; where it may lie is in ``support_polygon``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

LEAST_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]."""


def center_of_pressure(
    soles: Sequence[np.ndarray], wrenches: np.ndarray
) -> np.ndarray | None:
    """Where the ground's force acts on both soles together.

    Args:
        soles: Positions of the soles' centers in W [m], each of shape (3,).
        wrenches: Moment and force on each, at its center in W [N·m; N], shape (12,).

    Returns:
        Position in W [m], shape (3,), as high as the soles are in the mean of their
        loads; None without enough load.
    """
    total, moment = 0.0, np.zeros(3)
    for sole, wrench in zip(soles, wrenches.reshape(2, 6), strict=True):
        load = wrench[5]
        total += load
        moment += load * sole + np.array([-wrench[1], wrench[0], 0.0])
    return moment / total if total > LEAST_LOAD else None
