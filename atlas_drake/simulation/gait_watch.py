"""Lift-offs and touchdowns of the feet, told from the load on the soles.

Whichever controller the robot has. What happens at them is in ``push_schedule``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.scenario.pushes import LIFT_OFF, TOUCHDOWN

UNLOADED, LOADED = 0.01, 0.05
"""A foot is in the air below the one and on the ground above the other share of the
robot's weight; in between it is where it was [-]."""
LIFTED_FOR = 0.03
"""A foot has lifted off when it was in the air for this long: less is a jolt [s]."""
DOWN_FOR = 0.1
"""A foot that touched down stays on the ground for at least this long: what comes
sooner is a bounce [s]."""
VERTICAL = (5, 11)
"""Places of the feet's vertical forces in the station's ``foot_wrenches``."""


class GaitEvent(NamedTuple):
    """A foot, 0 for the left one, and what it did."""

    foot: int
    phase: str


@dataclass
class _Foot:
    """Where a foot is, and since when it touches the ground or not [s]."""

    down: bool | None = None
    touched: float = -math.inf
    unloaded: float | None = None

    def look(self, time: float, load: float) -> str | None:
        """Tells a lift-off or a touchdown.

        Args:
            time: Now [s].
            load: Share of the robot's weight [-].
        """
        if self.down is None:
            self.down = load > LOADED
        if not self.down:
            if load <= LOADED:
                return None
            self.down, self.touched, self.unloaded = True, time, None
            return TOUCHDOWN
        if load >= UNLOADED or time - self.touched < DOWN_FOR:
            self.unloaded = None
            return None
        if self.unloaded is None:
            self.unloaded = time
        if time - self.unloaded < LIFTED_FOR - 1e-9:
            return None
        self.down = False
        return LIFT_OFF


class GaitWatch:
    """Remembers where each foot was at the last look."""

    def __init__(self, weight: float) -> None:
        """Watches a robot of this weight [N]."""
        self._weight = weight
        self._feet = (_Foot(), _Foot())

    def look(self, time: float, wrenches: np.ndarray) -> list[GaitEvent]:
        """Takes in the loads of a control tick.

        Args:
            time: Now [s].
            wrenches: Of the ground on the soles [N·m; N], shape (12,).

        Returns:
            What happened since the look before; nothing at the first one.
        """
        events = []
        for index, (foot, place) in enumerate(zip(self._feet, VERTICAL, strict=True)):
            phase = foot.look(time, float(wrenches[place]) / self._weight)
            if phase is not None:
                events.append(GaitEvent(index, phase))
        return events
