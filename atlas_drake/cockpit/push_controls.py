"""Pushes on links."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.messages.checks import check_vector

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

DURATION = 0.1
"""Duration of a push, over which its impulse is spread [s]."""
LARGEST = 500.0
"""Largest impulse along an axis [N·s]."""


class PushControls:
    """Pushes on links."""

    def __init__(self, sim: AtlasSimulation) -> None:
        """Pushes the robot of a simulation."""
        self._sim = sim

    def push(self, body: str, impulse_W: Sequence[float]) -> float:
        """Pushes a link now, for ``DURATION``.

        Args:
            body: Name of the link.
            impulse_W: Impulse in W [N·s], shape (3,).

        Returns:
            The change of the robot's velocity that it makes [m/s].
        """
        impulse = check_vector(impulse_W, "impulse_W", 3, LARGEST)
        self._sim.apply_push(body, impulse / DURATION, DURATION)
        return float(np.linalg.norm(impulse) / self._sim.robot.mass)
