"""How motors keep their joints to the planned speeds between two control ticks.

Efforts that last for a tick do not know what happens within it: a foot that lands, a
punch. The motors know, as those of real robots do, whose drives close a loop of speed
around the efforts that are planned.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.joints.joint_pid import MotorLaw
from atlas_drake.frozen import read_only


def speed_hold(
    v: np.ndarray, acceleration: np.ndarray, damping: np.ndarray, period: float
) -> MotorLaw:
    """Returns the motors' law D·(v_p - v⁺), v_p the planned speed in mid-tick.

    Args:
        v: Speeds of the joints at the tick [rad/s], shape (n,).
        acceleration: Planned for the tick [rad/s²], shape (n,).
        damping: D [N·m·s/rad], shape (n,).
        period: Of the control ticks [s].
    """
    none, planned = np.zeros_like(v), v + 0.5 * period * acceleration
    return read_only(MotorLaw(none, damping, none, damping * planned))


def without_hold(n: int) -> MotorLaw:
    """Returns the law of ``n`` motors that give the planned efforts alone."""
    return read_only(MotorLaw(*np.zeros((4, n))))
