"""Obstacles of a world: a few numbers in, boxes out.

An obstacle's frame O lies where the robot meets the obstacle: at the middle of the
near edge, x ahead over the obstacle, z up. Which obstacles a world has, and where, is
in ``world_file``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len, MinLen
from pydrake.math import RigidTransform, RollPitchYaw

from atlas_drake.config import Configuration, Vector
from atlas_drake.errors import ScenarioError
from atlas_drake.units import Meters, Radians
from atlas_drake.worlds.terrain import Block

Length = Annotated[Meters, Interval(ge=0.01, le=100.0)]
"""A length of an obstacle."""
Tilt = Annotated[Radians, Interval(ge=0.0, le=1.0)]
"""An angle of a face against the level."""


@dataclass(frozen=True)
class Obstacle(Configuration):
    """Boxes that a few numbers describe."""

    position: Vector[Meters] = field(default_factory=lambda: [0.25, 0.0, 0.0])
    """Position of the middle of the near edge in W."""
    yaw: Radians = 0.0
    """Direction in which the obstacle lies ahead of that edge."""

    def blocks(self) -> list[Block]:
        """Returns the boxes, with poses in W."""
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
        """Returns the boxes, with poses in O."""
        raise NotImplementedError


_TREADS = ([0.72, 0.62, 0.50], [0.62, 0.53, 0.42])
"""Colors of the steps, in turn: neighbors must be told apart from above."""


@dataclass(frozen=True)
class Stairs(Obstacle):
    """A flight of steps that rises along x, and a landing on top."""

    rise: Length = 0.10
    """Height of each step. WALK takes 0.20 m with ``atlas``, 0.06 m with
    ``atlas_v3``."""
    run: Length = 0.35
    """Depth of each step."""
    number: Annotated[int, Interval(ge=1, le=100)] = 4
    """Number of steps; the last one is level with the landing."""
    width: Length = 1.6
    """Width of the steps."""
    landing: Annotated[Meters, Interval(ge=0.0, le=100.0)] = 1.2
    """Length of the landing behind the last step."""

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


_SLOPE, _LANDING = [0.55, 0.62, 0.66], [0.45, 0.52, 0.57]


@dataclass(frozen=True)
class Ramp(Obstacle):
    """A slope that rises along x, and a landing on top."""

    angle: Tilt = 0.14
    """Angle between slope and ground."""
    length: Length = 2.0
    """Length of the slope, along its face."""
    width: Length = 1.6
    """Width of slope and landing."""
    landing: Annotated[Meters, Interval(ge=0.0, le=100.0)] = 1.2
    """Length of the landing behind the slope; 0 leaves it out."""

    def _blocks_O(self) -> list[Block]:
        run = self.length * math.cos(self.angle)
        rise = self.length * math.sin(self.angle)
        # Thick enough to hide the ground below the upper end. What is below the ground
        # touches nothing.
        thickness = max(rise * math.cos(self.angle), 0.02)
        slope = Block(
            size=[self.length, self.width, thickness],
            position=[0.5 * run, 0.0, 0.5 * rise],
            rpy=[0.0, -self.angle, 0.0],
            color=_SLOPE,
        )
        if not (self.landing and rise):
            return [slope]
        landing = Block(
            size=[self.landing, self.width, rise],
            position=[run + 0.5 * self.landing, 0.0, rise],
            color=_LANDING,
        )
        return [slope, landing]


_SIDES = ((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))
"""Roll and pitch of the blocks in turn, as shares of the tilt: rising ahead, to the
left, backward, to the right."""
_LEANING = (
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
    """Length and width of each block."""
    gap: Annotated[Meters, Interval(ge=0.0, le=10.0)] = 0.02
    """Distance between blocks."""
    tilt: Tilt = 0.10
    """Angle of each top against the level."""
    heights: Annotated[list[Length], MinLen(1)] = field(
        default_factory=lambda: [0.06, 0.10, 0.14, 0.10]
    )
    """Heights of the middles of the tops, row by row; the list repeats."""

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
                        color=list(_LEANING[side]),
                    )
                )
        return blocks


_BRICKS = ([0.66, 0.33, 0.24], [0.72, 0.40, 0.28], [0.58, 0.29, 0.22])
_TRIES = 200
"""Places tried for each brick before the area counts as full."""
_LARGEST_SEED = 2**53


@dataclass(frozen=True)
class Rubble(Obstacle):
    """Bricks at random places of an area, none on top of another."""

    number: Annotated[int, Interval(ge=0, le=1000)] = 60
    """Number of bricks."""
    size: Annotated[list[Length], Len(3, 3)] = field(
        default_factory=lambda: [0.20, 0.10, 0.05]
    )
    """Length, width and height of a brick."""
    sunk: Annotated[Meters, Interval(ge=0.0, le=1.0)] = 0.0
    """Greatest depth to which a brick is sunk into the ground, each to a random one;
    less than its height."""
    area: Annotated[list[Length], Len(2, 2)] = field(default_factory=lambda: [4.0, 3.0])
    """Area of the bricks' middles, along x and y."""
    seed: Annotated[int, Interval(ge=0, le=_LARGEST_SEED)] = 0
    """Seed of the places; independent of the scenario's seed, so that runs of several
    seeds meet the same bricks."""

    def check(self) -> None:
        """Checks that the bricks find room, and that their tops are above ground."""
        if self.sunk >= self.size[2]:
            problem = f"must be less than the bricks' height, {self.size[2]:g}"
            raise ScenarioError.about("sunk", self.sunk, problem)
        placed = len(self._places())
        if placed < self.number:
            problem = f"only {placed} bricks find room in an area of {self.area}"
            raise ScenarioError.about("number", self.number, problem)

    def _blocks_O(self) -> list[Block]:
        depths = np.random.default_rng([self.seed, 1]).uniform(
            0, self.sunk, self.number
        )
        return [
            Block(
                size=list(self.size),
                position=[x, y, self.size[2] - float(depth)],
                rpy=[0.0, 0.0, yaw],
                color=list(_BRICKS[index % len(_BRICKS)]),
            )
            for index, ((x, y, yaw), depth) in enumerate(
                zip(self._places(), depths, strict=True)
            )
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
