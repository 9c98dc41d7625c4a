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
    """Moves a wrench from W's origin to the point Q, in place.

    Args:
        wrench: Moment and force in W [N·m; N], shape (6,).
        p_WQ: The point in W [m], shape (3,).
    """
    wrench[:3] -= cross(p_WQ, wrench[3:])


def shift_to_frames(wrenches: np.ndarray, frames: Iterable[Any], context: Any) -> None:
    """Moves wrenches from W's origin to the origins of frames, in place.

    Args:
        wrenches: Moments and forces in W [N·m; N], shape (k, 6).
        frames: Drake's frames, one per wrench; further wrenches stay.
        context: Context of the frames' plant, at the pose that counts.
    """
    for wrench, frame in zip(wrenches, frames, strict=False):
        if wrench.any():
            shift_wrench(wrench, frame.CalcPoseInWorld(context).translation())


LEAST_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]. Numerical:
the CoP of a smaller force is noise."""


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
