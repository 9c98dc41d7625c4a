"""How softly the feet land, and how still they rest: slip of each step, and peak load.

``touchdowns.yaml`` measures it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from atlas_drake import AtlasSimulation, Behavior
from atlas_drake.clients.logs.failure_modes import BEARING
from atlas_drake.records import TickRecord
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_matrix
from atlas_drake.units import GRAVITY

FLAT = math.cos(0.05)
"""Cosine of the largest tilt of a sole that rests: one that rolls does not slip."""


class Touchdowns:
    """Slip of each sole while it rests flat, and the loads of the touchdowns."""

    def __init__(self, robot: Robot) -> None:
        """Measures ``robot``."""
        self._weight = robot.mass * GRAVITY
        self._since: list[np.ndarray | None] = [None, None]
        self._slip = [0.0, 0.0]
        self._slips: list[float] = []
        self._peak = 0.0

    def update(self, record: TickRecord) -> None:
        """Adds a record of a walk; before it the robot drops from a random pose."""
        if record.behavior.current != Behavior.WALK:
            return
        feet = record.feet
        for foot, load in enumerate(feet.loads):
            self._peak = max(self._peak, load / self._weight)
            upright = rotation_matrix(feet.orientations[foot])[2, 2]
            xy, since = feet.positions[foot][:2], self._since[foot]
            if load < BEARING * self._weight or upright < FLAT:
                if since is not None:
                    self._slips.append(self._slip[foot])
                self._since[foot], self._slip[foot] = None, 0.0
            elif since is None:
                self._since[foot] = xy
            else:
                slip = float(np.hypot(*(xy - since)))
                self._slip[foot] = max(self._slip[foot], slip)

    def result(self, sim: AtlasSimulation) -> dict[str, Any]:
        """Returns the figures; those of the first stance of each foot count, too."""
        return {
            "slip_mean_m": float(np.mean(self._slips)) if self._slips else math.nan,
            "slip_max_m": max(self._slips, default=math.nan),
            "peak_load": self._peak,
        }
