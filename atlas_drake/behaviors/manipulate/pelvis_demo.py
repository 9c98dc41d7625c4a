"""The movement of MANIPULATE's demo mode: one coordinate after the other, repeated.

A pure function of time; ``manipulate`` tracks the movement.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from atlas_drake.control.pelvis.pelvis_pose import PelvisPose

PERIOD = 6.0
"""Duration of each movement [s]."""
MOVEMENTS = (
    ("height", -0.10, "dip"),
    ("yaw", 0.12, "sway"),
    ("pitch", 0.20, "sway"),
    ("roll", 0.15, "sway"),
    ("com_v0", 0.06, "sway"),
    ("com_v1", 0.04, "sway"),
)
"""Coordinate, amplitude [m] or [rad], and shape of each movement: a dip goes to one
side, a sway to both."""
SWAY_GAIN = 1.54
"""Factor that scales the largest value of a sway to 1 [-]."""
_TRIALS = 60
"""Number of times in one round at which the reach of the legs is checked."""
_SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of the whole movement to try, largest first [-]."""


def demo_pose(home: PelvisPose, share: float, time: float) -> PelvisPose:
    """Computes the pose of the demo about ``home``, ``share`` of the whole movement."""
    index, phase = divmod(time / PERIOD, 1.0)
    name, size, kind = MOVEMENTS[int(index) % len(MOVEMENTS)]
    # Begins and ends at rest.
    dip = 0.5 - 0.5 * math.cos(math.tau * phase)
    wave = dip if kind == "dip" else SWAY_GAIN * dip * math.sin(math.tau * phase)
    return home._replace(**{name: getattr(home, name) + share * size * wave})


def demo_amplitude(home: PelvisPose, allows: Callable[[PelvisPose], bool]) -> float:
    """Finds the largest share of the movement whose poses are all possible, or 0."""
    round_time = PERIOD * len(MOVEMENTS)
    times = [round_time * i / _TRIALS for i in range(_TRIALS)]
    for share in _SHARES:
        if all(allows(demo_pose(home, share, time)) for time in times):
            return share
    return 0.0
