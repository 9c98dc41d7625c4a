"""Terrain: boxes on the level ground, and the height of the surface.

Geometry and its checks; ``diagrams`` adds the boxes to plant and 3D view.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.config import Configuration, Positive, Share, Vector
from atlas_drake.errors import ScenarioError
from atlas_drake.units import Meters, Radians, Ratio

GROUND_SIZE, GROUND_THICKNESS = 2e4, 100.0
"""Side and thickness of the ground [m]. The narrow phase tilts the normals of cylinders
and meshes by 2e-10 rad for each meter of the side."""
START_REACH = 5e3
"""Distance from W's origin along each axis at which a robot can start [m]: hours of
walking away from the edge of the ground."""
Place = Annotated[
    list[Annotated[Meters, Interval(ge=-START_REACH, le=START_REACH)]], Len(2, 2)
]
"""Position of a start on the ground."""
BLOCK_COLOR = np.array([0.80, 0.70, 0.56, 1.0])
"""Red, green, blue, alpha of boxes without a color: light wood on the pale ground."""
_PARALLEL = 1e-12
"""Component of a unit vector below which the vector is parallel to a face [-]."""


@dataclass(frozen=True)
class Block(Configuration):
    """A fixed box. The origin of its frame T is the middle of the top face."""

    size: Vector[Meters] = field(default_factory=lambda: [1.0, 1.0, 0.1])
    """Size along the axes of T."""
    position: Vector[Meters] = field(default_factory=lambda: [0.0, 0.0, 0.1])
    """Position of the middle of the top face in W."""
    rpy: Vector[Radians] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Roll, pitch and yaw of T in W."""
    friction: Positive[Ratio] | None = None
    """Friction coefficient; the ground's coefficient if left out."""
    color: Annotated[list[Share], Len(3, 3)] | None = None
    """Red, green and blue, from 0 to 1; light wood if left out."""

    def check(self) -> None:
        """Checks that the box has a volume."""
        if min(self.size) <= 0.0:
            raise ScenarioError.about("size", self.size, "must be positive")

    @property
    def rgba(self) -> np.ndarray:
        """Red, green, blue and alpha of the box, shape (4,)."""
        return BLOCK_COLOR if self.color is None else np.array([*self.color, 1.0])

    @property
    def X_WT(self) -> RigidTransform:
        """Pose of the top face, z along its normal."""
        return RigidTransform(RollPitchYaw(self.rpy), self.position)

    @property
    def X_WC(self) -> RigidTransform:
        """Pose of the middle of the box."""
        return self.X_WT @ RigidTransform([0.0, 0.0, -0.5 * self.size[2]])


def surface_height(terrain: Iterable[Block], x: float, y: float) -> float:
    """Computes the height of the highest surface above a point of the ground [m]."""
    heights = (_height_on(block, x, y) for block in terrain)
    return max((z for z in heights if z is not None), default=0.0)


def _height_on(block: Block, x: float, y: float) -> float | None:
    """Computes the height at which the vertical through (x, y) leaves the box [m].

    The box is the intersection of three slabs. In each slab the vertical spans a range
    of heights; the box contains the intersection of these ranges. None if it is empty.
    """
    X_CW = block.X_WC.inverse()
    foot = X_CW @ np.array([x, y, 0.0])
    up = X_CW.rotation().matrix()[:, 2]
    low, high = -math.inf, math.inf
    for axis in range(3):
        half, at, rate = 0.5 * block.size[axis], float(foot[axis]), float(up[axis])
        if abs(rate) < _PARALLEL:
            if abs(at) > half:
                return None
            continue
        ends = sorted(((-half - at) / rate, (half - at) / rate))
        low, high = max(low, ends[0]), min(high, ends[1])
    return high if low <= high else None
