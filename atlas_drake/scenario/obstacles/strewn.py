"""Strewn bricks, which do not move: at random places, the same for the same seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len

from atlas_drake.errors import ScenarioError
from atlas_drake.scenario.obstacles.obstacle import Length, Obstacle
from atlas_drake.scenario.terrain import Block

_COLORS = ([0.66, 0.33, 0.24], [0.72, 0.40, 0.28], [0.58, 0.29, 0.22])
_TRIES = 200
"""Places tried for each brick before the area counts as full."""
_LARGEST_SEED = 2**53


@dataclass(frozen=True)
class Strewn(Obstacle):
    """Bricks at random places of an area, none on top of another."""

    number: Annotated[int, Interval(ge=0, le=1000)] = 60
    """Number of bricks."""
    size: Annotated[list[Length], Len(3, 3)] = field(
        default_factory=lambda: [0.20, 0.10, 0.05]
    )
    """Length, width and height of a brick [m]."""
    area: Annotated[list[Length], Len(2, 2)] = field(default_factory=lambda: [4.0, 3.0])
    """Area of the bricks' middles, along x and y [m]."""
    seed: Annotated[int, Interval(ge=0, le=_LARGEST_SEED)] = 0
    """Seed of the places; independent of the scenario's seed, so that runs of several
    seeds meet the same bricks."""

    def check(self) -> None:
        """Checks that the bricks find room."""
        placed = len(self._places())
        if placed < self.number:
            raise ScenarioError(
                "number",
                self.number,
                f"is {self.number}; only {placed} bricks of {self.size} find room in "
                f"an area of {self.area}",
            )

    def _blocks_O(self) -> list[Block]:
        return [
            Block(
                size=list(self.size),
                position=[x, y, self.size[2]],
                rpy=[0.0, 0.0, yaw],
                color=list(_COLORS[index % len(_COLORS)]),
            )
            for index, (x, y, yaw) in enumerate(self._places())
        ]

    def _places(self) -> list[tuple[float, float, float]]:
        """Places of bricks in O: x, y [m], yaw [rad]; fewer where there is no room."""
        random = np.random.default_rng(self.seed)
        apart = math.hypot(self.size[0], self.size[1])
        found = np.zeros((0, 3))
        for _ in range(self.number):
            low = [0.0, -0.5 * self.area[1], 0.0]
            high = [self.area[0], 0.5 * self.area[1], math.pi]
            tries = random.uniform(low, high, size=(_TRIES, 3))
            offsets = tries[:, None, :2] - found[None, :, :2]
            free = (np.linalg.norm(offsets, axis=2) >= apart).all(axis=1)
            if not free.any():
                break
            found = np.vstack([found, tries[np.argmax(free)]])
        return [(float(x), float(y), float(yaw)) for x, y, yaw in found]
