"""How motors keep their joints to planned speeds between two control ticks.

Efforts that last for a tick do not know what happens within it: a foot that lands, a
punch. The motors know, as those of real robots do, whose drives close a loop of speed
around the efforts that are planned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import Frozen, read_only

FALL_DAMPING = 0.002
"""Damping of the joints of a falling robot, in their greatest efforts per rad/s.

No setting: a falling robot protects itself, and only the order of magnitude counts. A
joint that turns at 10 rad/s is braked with a fiftieth of its effort limit: it sags and
absorbs a part of the impact, limbs do not whip, and nothing is pushed hard against the
ground.
"""


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


def damped(effort_limit: np.ndarray) -> SpeedHold:
    """Returns what brakes the joints of a falling robot; limits [N·m], shape (n,)."""
    return read_only(
        SpeedHold(FALL_DAMPING * effort_limit, np.zeros_like(effort_limit))
    )
