"""Blocks: a field of footholds that are tilted to all sides."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Interval, MinLen

from atlas_drake.scenario.obstacles.obstacle import Length, Obstacle, Tilt
from atlas_drake.scenario.terrain import Block

_SIDES = ((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))
"""Roll and pitch of the blocks in turn, as shares of the tilt: rising ahead, to the
left, backward, to the right."""
_COLORS = (
    [0.66, 0.66, 0.64],
    [0.58, 0.60, 0.62],
    [0.52, 0.52, 0.50],
    [0.61, 0.57, 0.53],
)
"""One for each of these, so that one sees which way a block leans."""


@dataclass(frozen=True)
class Blocks(Obstacle):
    """Rows and columns of blocks, each tilted to another side than its neighbors."""

    rows: Annotated[int, Interval(ge=1, le=50)] = 4
    """Number of blocks along x."""
    columns: Annotated[int, Interval(ge=1, le=50)] = 2
    """Number of blocks along y."""
    size: Length = 0.36
    """Length and width of each block [m]."""
    gap: Annotated[float, Interval(ge=0.0, le=10.0)] = 0.02
    """Distance between blocks [m]."""
    tilt: Tilt = 0.10
    """Angle of each top against the level [rad]."""
    heights: Annotated[list[Length], MinLen(1)] = field(
        default_factory=lambda: [0.06, 0.10, 0.14, 0.10]
    )
    """Heights of the middles of the tops, row by row; the list repeats [m]."""

    def _blocks_O(self) -> list[Block]:
        pitch = self.size + self.gap
        higher = 0.5 * self.size * math.sin(self.tilt)
        blocks = []
        for row in range(self.rows):
            for column in range(self.columns):
                side = (row + 2 * column) % len(_SIDES)
                roll, pitch_share = _SIDES[side]
                height = self.heights[row % len(self.heights)]
                # The highest edge of the bottom lies on the ground, the rest below it.
                thickness = (height + higher) / math.cos(self.tilt)
                x = row * pitch + 0.5 * self.size
                y = (0.5 * (self.columns - 1) - column) * pitch
                blocks.append(
                    Block(
                        size=[self.size, self.size, thickness],
                        position=[x, y, height],
                        rpy=[roll * self.tilt, pitch_share * self.tilt, 0.0],
                        color=list(_COLORS[side]),
                    )
                )
        return blocks
