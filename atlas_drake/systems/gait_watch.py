"""Lift-offs and touchdowns of the feet, detected from the load on the soles.

Holds for any controller of the robot. ``PushSource`` times pushes by them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from atlas_drake.frozen import Frozen
from atlas_drake.scenario.pushes import LIFT_OFF, TOUCHDOWN

UNLOADED, LOADED = 0.01, 0.05
"""Shares of the robot's weight below which a foot is in the air, and above which it is
on the ground; in between its state does not change [-]."""
LIFTED_FOR = 0.03
"""Time in the air after which a foot has lifted off: less is a jolt [s]."""
DOWN_FOR = 0.1
"""Least time on the ground after a touchdown: a lift-off within it is a bounce [s]."""


@dataclass(frozen=True)
class FootLoad(Frozen):
    """State of one foot.

    Attributes:
        down: True if the foot is on the ground; None before the first load.
        touched: Time of the last touchdown [s].
        unloaded: Time since which a foot on the ground carries nothing [s].
    """

    down: bool | None = None
    touched: float = -math.inf
    unloaded: float | None = None

    def after(self, time: float, load: float) -> tuple[FootLoad, str | None]:
        """Returns the state after a load, and a lift-off or touchdown at it, if any.

        Args:
            time: Present time [s].
            load: Share of the robot's weight on this foot [-].
        """
        if self.down is None:
            return FootLoad(load > LOADED), None
        if not self.down:
            if load <= LOADED:
                return self, None
            return FootLoad(True, time), TOUCHDOWN
        if load >= UNLOADED or time - self.touched < DOWN_FOR:
            return FootLoad(True, self.touched), None
        unloaded = time if self.unloaded is None else self.unloaded
        if time - unloaded < LIFTED_FOR - 1e-9:
            return FootLoad(True, self.touched, unloaded), None
        return FootLoad(False, self.touched), LIFT_OFF
