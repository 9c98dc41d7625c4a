"""What all obstacles share: where they begin, and their boxes put there.

An obstacle's frame O lies where the robot meets the obstacle: at the middle of the
near edge, x ahead over the obstacle, z up.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from annotated_types import Interval
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.configuration import Configuration, Vector
from atlas_drake.scenario.terrain import Block

Length = Annotated[float, Interval(ge=0.01, le=100.0)]
"""A length of an obstacle [m]."""
Tilt = Annotated[float, Interval(ge=0.0, le=1.0)]
"""An angle of a face against the level [rad]."""


@dataclass(frozen=True)
class Obstacle(Configuration):
    """Boxes that a few numbers describe."""

    position: Vector = field(default_factory=lambda: [0.25, 0.0, 0.0])
    """Position of the middle of the near edge in W [m]."""
    yaw: float = 0.0
    """Direction in which the obstacle lies ahead of that edge [rad]."""

    def blocks(self) -> list[Block]:
        """Return the boxes, with poses in W."""
        p_WO = np.array(self.position)
        X_WO = RigidTransform(RollPitchYaw(0.0, 0.0, self.yaw), p_WO)
        return [
            replace(
                block,
                position=(X_WO @ np.array(block.position)).tolist(),
                # Yaw is the last of the three rotations, so that yaws add up.
                rpy=[block.rpy[0], block.rpy[1], block.rpy[2] + self.yaw],
            )
            for block in self._blocks_O()
        ]

    def _blocks_O(self) -> list[Block]:
        """The boxes, with poses in O."""
        raise NotImplementedError
