"""A ramp: a slope up to a landing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from atlas_drake.scenario.obstacles.obstacle import Length, Obstacle, Tilt
from atlas_drake.scenario.terrain import Block

_SLOPE, _LANDING = [0.55, 0.62, 0.66], [0.45, 0.52, 0.57]


@dataclass(frozen=True)
class Ramp(Obstacle):
    """A slope that rises along x, and a landing on top."""

    angle: Tilt = 0.14
    """Angle between slope and ground [rad]."""
    length: Length = 2.0
    """Length of the slope, along its face [m]."""
    width: Length = 1.6
    """Width of slope and landing [m]."""
    landing: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.2
    """Length of the landing behind the slope [m]; 0 leaves it out."""

    def _blocks_O(self) -> list[Block]:
        run, rise = (
            self.length * math.cos(self.angle),
            self.length * math.sin(self.angle),
        )
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
