"""What the hands carry, from the vertical forces on them.

The mass on a hand follows the force: a squeeze, a bump or a touchdown is over before it
counts. A table that the hands lean on pushes up, and is no load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.units import GRAVITY, Kilograms, Seconds


@dataclass(frozen=True)
class HandLoads(Configuration):
    """How loads on the hands become part of the controller's model."""

    delay: NotNegative[Seconds] = 0.15
    """Time constant with which the model's loads follow the forces."""
    least: NotNegative[Kilograms] = 0.5
    """Mass from which a hand counts as carrying something."""

    def follow(self, loads: np.ndarray, force: np.ndarray, dt: float) -> np.ndarray:
        """Returns the masses after a tick.

        Args:
            loads: Masses on the left and the right hand before it [kg], shape (2,).
            force: Upward forces on the hands [N], shape (2,).
            dt: Length of the tick [s].
        """
        felt = np.maximum(-force / GRAVITY, 0.0)
        after = loads + dt / (dt + self.delay) * (felt - loads)
        empty = (felt == 0.0) & (after < self.least)
        return np.where(empty, 0.0, after)

    def news(self, before: np.ndarray, after: np.ndarray) -> list[str]:
        """Says which hands have taken up or given away a load."""
        carried, carries = self.counted(before) > 0.0, self.counted(after) > 0.0
        return [
            f"the {side} hand {'takes up a load' if now else 'is empty again'}"
            for side, then, now in zip(("left", "right"), carried, carries, strict=True)
            if then != now
        ]

    def counted(self, loads: np.ndarray) -> np.ndarray:
        """Returns the masses that the model has [kg], shape (2,)."""
        return np.where(loads < self.least, 0.0, loads)
