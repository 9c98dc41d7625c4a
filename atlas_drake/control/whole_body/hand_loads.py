"""What the hands carry and what pulls at them, from the wrenches on them.

Both follow the wrenches slowly: a bump or a touchdown is over before it counts. A table
that the hands lean on pushes up, and is no load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.units import GRAVITY, Kilograms, Seconds


@dataclass(frozen=True)
class HandLoads(Configuration):
    """How forces on the hands become part of the controller's model."""

    delay: NotNegative[Seconds] = 0.15
    """Time constant with which the model follows the forces."""
    least: NotNegative[Kilograms] = 0.5
    """Mass from which a hand counts as carrying something."""

    def follow(self, wrenches: np.ndarray, felt: np.ndarray, dt: float) -> np.ndarray:
        """Returns the wrenches of the model after a tick.

        Args:
            wrenches: Those of the left and the right hand before it [N·m; N], shape
                (2, 6).
            felt: The measured ones.
            dt: Length of the tick [s].
        """
        after = wrenches + dt / (dt + self.delay) * (felt - wrenches)
        faint = np.linalg.norm(after[:, 3:], axis=1) < self.least * GRAVITY
        after[faint & ~felt.any(axis=1)] = 0.0
        return after

    def carried(self, wrenches: np.ndarray) -> np.ndarray:
        """Returns the masses that left and right hand carry [kg], shape (2,)."""
        masses = -wrenches[:, 5] / GRAVITY
        return np.where(masses < self.least, 0.0, masses)

    def news(self, before: np.ndarray, after: np.ndarray) -> list[str]:
        """Says which hands have taken up or given away a load."""
        carried, carries = self.carried(before) > 0.0, self.carried(after) > 0.0
        return [
            f"the {side} hand {'takes up a load' if now else 'is empty again'}"
            for side, then, now in zip(("left", "right"), carried, carries, strict=True)
            if then != now
        ]
