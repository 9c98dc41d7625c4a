"""Stairs: a flight of solid steps up to a landing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from atlas_drake.scenario.obstacles.obstacle import Length, Obstacle
from atlas_drake.scenario.terrain import Block

_TREADS = ([0.72, 0.62, 0.50], [0.62, 0.53, 0.42])
"""Colors of the steps, in turn: neighbors must be told apart from above."""


@dataclass(frozen=True)
class Stairs(Obstacle):
    """A flight of steps that rises along x, and a landing on top."""

    rise: Length = 0.10
    """Height of each step [m]. WALK takes 0.10 m with ``atlas``, 0.06 m with
    ``atlas_v3``."""
    run: Length = 0.35
    """Depth of each step [m]."""
    number: Annotated[int, Interval(ge=1, le=100)] = 4
    """Number of steps; the last one is level with the landing."""
    width: Length = 1.6
    """Width of the steps [m]."""
    landing: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.2
    """Length of the landing behind the last step [m]."""

    def _blocks_O(self) -> list[Block]:
        blocks = []
        for step in range(1, self.number + 1):
            depth = self.run + (self.landing if step == self.number else 0.0)
            near, top = (step - 1) * self.run, step * self.rise
            blocks.append(
                Block(
                    size=[depth, self.width, top],
                    position=[near + 0.5 * depth, 0.0, top],
                    color=list(_TREADS[step % 2]),
                )
            )
        return blocks
