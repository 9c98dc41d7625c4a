"""Obstacles of a world: a few numbers in, boxes out.

One kind per file. Which of them a world has, and where, is in ``world_file``.
"""

from atlas_drake.scenario.obstacles.blocks import Blocks
from atlas_drake.scenario.obstacles.obstacle import Obstacle
from atlas_drake.scenario.obstacles.ramp import Ramp
from atlas_drake.scenario.obstacles.stairs import Stairs
from atlas_drake.scenario.obstacles.strewn import Strewn

__all__ = ["Blocks", "Obstacle", "Ramp", "Stairs", "Strewn"]
