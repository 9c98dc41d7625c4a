"""Measured contact wrenches: moved to the frames that they act on, and their center.

The sensors sum the forces of single contacts about the origin of W, which needs no
poses; see ``systems.robot_sensors``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from atlas_drake.rotations import cross


def shift_wrench(wrench: np.ndarray, p_WQ: np.ndarray) -> None:
    """Moves a wrench [N·m; N] from W's origin to the point Q [m], in place."""
    wrench[:3] -= cross(p_WQ, wrench[3:])


def shift_to_frames(wrenches: np.ndarray, frames: Iterable[Any], context: Any) -> None:
    """Moves wrenches [N·m; N] from W's origin to those of Drake's frames, in place.

    There is one frame per wrench; further wrenches stay.
    """
    for wrench, frame in zip(wrenches, frames, strict=False):
        if wrench.any():
            shift_wrench(wrench, frame.CalcPoseInWorld(context).translation())


MIN_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]. Numerical:
the CoP of a smaller force is noise."""


def center_of_pressure(
    soles: Sequence[np.ndarray], wrenches: np.ndarray
) -> np.ndarray | None:
    """Computes the CoP of both soles together in W [m], (3,); None below MIN_LOAD.

    The wrenches [N·m; N], (12,), act at the soles' centers. The CoP is at the
    load-weighted mean height of the soles.
    """
    total, moment = 0.0, np.zeros(3)
    for sole, wrench in zip(soles, wrenches.reshape(2, 6), strict=True):
        load = wrench[5]
        total += load
        moment += load * sole + np.array([-wrench[1], wrench[0], 0.0])
    return moment / total if total > MIN_LOAD else None
