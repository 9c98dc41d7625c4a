"""The layout of a leg whose inverse kinematics has a closed form.

From the pelvis down hip z, hip x, hip y, knee y, ankle y, ankle x. With all joints at
zero every joint's frame and the sole's are parallel to the pelvis', hip z and hip x
meet in the hip's center, ankle y and ankle x in the ankle, and hip y, knee and ankle
lie in one plane x-z, the leg's, through the hip's center or beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from atlas_drake.frozen import read_only

_AXES = np.eye(3)[[2, 0, 1, 1, 1, 0]]
_TOLERANCE = 1e-6
"""Tolerance of positions and axes [m], [-]."""


@dataclass(frozen=True)
class PlanarLeg:
    """Where the leg's plane lies in the pelvis.

    Attributes:
        p_PH: Hip center, where hip z and hip x meet, in the pelvis frame [m].
        lateral_offset: Distance of the leg's plane, with hip y, knee and ankle, from
            the hip center to the left [m].
        hip: Hip y axis from the hip center along x and z [m].
    """

    p_PH: np.ndarray
    lateral_offset: float
    hip: tuple[float, float]

    @cached_property
    def p_HT(self) -> np.ndarray:
        """Hip y from the hip center with all joints at zero [m], shape (3,)."""
        return read_only(np.array([self.hip[0], self.lateral_offset, self.hip[1]]))

    @cached_property
    def p_PT(self) -> np.ndarray:
        """Hip y in the pelvis frame with all joints at zero [m], shape (3,)."""
        return self.p_PH + self.p_HT


def planar_leg(
    axes: np.ndarray, points: np.ndarray, poses: Sequence[Any]
) -> PlanarLeg | None:
    """Returns the layout of six axes with points on them; None if it is another.

    ``poses`` are those of the six joints and of the sole in the pelvis.
    """
    p = points
    parallel = all(
        np.allclose(pose.rotation().matrix(), np.eye(3), atol=_TOLERANCE)
        for pose in poses
    )
    is_planar = (
        parallel
        and np.allclose(axes, _AXES, atol=_TOLERANCE)
        and np.allclose(p[1], p[0], atol=_TOLERANCE)
        and np.allclose(p[5], p[4], atol=_TOLERANCE)
        and np.allclose(p[3:, 1], p[2, 1], atol=_TOLERANCE)
    )
    if not is_planar:
        return None
    return PlanarLeg(
        p_PH=p[0],
        lateral_offset=float(p[2][1] - p[0][1]),
        hip=(float(p[2][0] - p[1][0]), float(p[2][2] - p[1][2])),
    )
