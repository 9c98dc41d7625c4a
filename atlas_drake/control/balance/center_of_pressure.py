"""Measured center of pressure (CoP), from the wrenches on both soles.

The region in which the CoP may lie is in ``support_polygon``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

LEAST_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]."""


def center_of_pressure(
    soles: Sequence[np.ndarray], wrenches: np.ndarray
) -> np.ndarray | None:
    """Computes the center of pressure of both soles together.

    Args:
        soles: Positions of the soles' centers in W [m], each of shape (3,).
        wrenches: Moment and force on each sole, at its center in W [N·m; N], shape
            (12,).

    Returns:
        Position in W [m], shape (3,), at the load-weighted mean height of the soles;
        None if the load is below LEAST_LOAD.
    """
    total, moment = 0.0, np.zeros(3)
    for sole, wrench in zip(soles, wrenches.reshape(2, 6), strict=True):
        load = wrench[5]
        total += load
        moment += load * sole + np.array([-wrench[1], wrench[0], 0.0])
    return moment / total if total > LEAST_LOAD else None
