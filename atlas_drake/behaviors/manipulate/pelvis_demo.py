"""The movement of MANIPULATE's demo mode: one thing after the other, for ever.

A pure function of time. How it is followed is ``manipulate``'s business.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from atlas_drake.control.pelvis.pelvis_pose import PelvisPose

PERIOD = 6.0
"""Each of the movements takes so long [s]."""
MOVEMENTS = (
    ("height", -0.10, "dip"),
    ("yaw", 0.12, "sway"),
    ("pitch", 0.20, "sway"),
    ("roll", 0.15, "sway"),
    ("com_v0", 0.06, "sway"),
    ("com_v1", 0.04, "sway"),
)
"""What moves, how far [m], [rad], and whether to one side only or to both."""
SWAY_GAIN = 1.54
"""Brings the largest value of a sway to 1 [-]."""
_TRIALS = 60
"""Moments of one round at which the legs are asked whether they can."""
_SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of the whole movement that are tried, largest first [-]."""


def demo_pose(home: PelvisPose, share: float, time: float) -> PelvisPose:
    """The pose at a time since the demo began.

    Args:
        home: The pose about which it moves.
        share: Of the whole movement, 0 to 1 [-].
        time: [s]
    """
    index, phase = divmod(time / PERIOD, 1.0)
    name, size, kind = MOVEMENTS[int(index) % len(MOVEMENTS)]
    # Begins and ends at rest.
    dip = 0.5 - 0.5 * math.cos(math.tau * phase)
    wave = dip if kind == "dip" else SWAY_GAIN * dip * math.sin(math.tau * phase)
    return home._replace(**{name: getattr(home, name) + share * size * wave})


def demo_amplitude(home: PelvisPose, allows: Callable[[PelvisPose], bool]) -> float:
    """The largest share of the movement that is possible throughout; 0 for none."""
    round_time = PERIOD * len(MOVEMENTS)
    times = [round_time * i / _TRIALS for i in range(_TRIALS)]
    for share in _SHARES:
        if all(allows(demo_pose(home, share, time)) for time in times):
            return share
    return 0.0
