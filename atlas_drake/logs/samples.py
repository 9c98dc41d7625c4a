"""Pure parts of a log's row: the CoP.

Which ports they come from is in ``recorder``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

LEAST_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]."""


def centre_of_pressure(
    soles: Sequence[np.ndarray], wrenches: np.ndarray
) -> np.ndarray | None:
    """Where the ground's force acts on both soles together.

    Args:
        soles: Positions of the soles' centres in W [m].
        wrenches: Moment and force on each, at its centre in W [N·m; N], shape (12,).

    Returns:
        Horizontal position in W [m], shape (2,); None without enough load.
    """
    total, moment = 0.0, np.zeros(2)
    for sole, wrench in zip(soles, wrenches.reshape(2, 6), strict=True):
        load = wrench[5]
        total += load
        moment += load * sole[:2] + np.array([-wrench[1], wrench[0]])
    return moment / total if total > LEAST_LOAD else None
