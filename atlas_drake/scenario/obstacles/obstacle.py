"""What all obstacles share: where they begin, and their boxes put there.

An obstacle's frame O lies where the robot meets the obstacle: at the middle of the
near edge, x ahead over the obstacle, z up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.bounds import Bounds
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.scenario.terrain import Block

Length = Annotated[float, Bounds(0.01, 100.0)]
"""A length of an obstacle [m]."""
Tilt = Annotated[float, Bounds(0.0, 1.0)]
"""An angle of a face against the level [rad]."""


@dataclass
class Obstacle:
    """Boxes that a few numbers describe."""

    position: list[float] = field(default_factory=lambda: [0.25, 0.0, 0.0])
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

    def validate(self, path: str) -> None:
        """Check what bounds of single numbers do not.

        Args:
            path: Where the obstacle is in its scenario, such as ``world.stairs``.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        position = self.position
        if len(position) != 3 or not all(map(math.isfinite, position)):
            raise ScenarioError(
                f"{path}.position",
                position,
                f"is {shown(position)}; must be three numbers",
            )
        if not math.isfinite(self.yaw):
            raise ScenarioError(
                f"{path}.yaw", self.yaw, f"is {shown(self.yaw)}; must be a number"
            )

    def _blocks_O(self) -> list[Block]:
        """The boxes, with poses in O."""
        raise NotImplementedError
