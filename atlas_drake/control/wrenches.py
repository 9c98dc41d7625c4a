"""Contact wrenches, moved from the world's origin to the frames that they act on.

The sensors sum the forces of single contacts about the origin of W, which needs no
poses; see ``systems.robot_sensors``.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from atlas_drake.control.rotations import cross


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
