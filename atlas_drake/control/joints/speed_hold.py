"""How motors keep their joints to the planned speeds between two control ticks.

Efforts that last for a tick do not know what happens within it: a foot that lands, a
punch. The motors know, as those of real robots do, whose drives close a loop of speed
around the efforts that are planned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import Frozen, read_only


@dataclass(frozen=True)
class SpeedHold(Frozen):
    """What motors add to planned efforts in each physics step: D·(v_p - v⁺).

    Attributes:
        damping: D [N·m·s/rad], shape (n,), message order.
        speed: v_p, planned for the middle of the tick [rad/s], shape (n,).
    """

    damping: np.ndarray
    speed: np.ndarray

    @classmethod
    def planned(
        cls,
        v: np.ndarray,
        acceleration: np.ndarray,
        damping: np.ndarray,
        period: float,
    ) -> SpeedHold:
        """Returns the hold of a tick, read-only.

        Args:
            v: Speeds of the joints at the tick [rad/s], shape (n,).
            acceleration: Planned for the tick [rad/s²], shape (n,).
            damping: D [N·m·s/rad], shape (n,).
            period: Of the control ticks [s].
        """
        return read_only(cls(damping, v + 0.5 * period * acceleration))
