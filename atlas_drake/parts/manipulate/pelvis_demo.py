"""The movement of MANIPULATE's demo mode: one coordinate after the other, repeated.

A pure function of time; ``manipulate`` tracks the movement.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.parts.manipulate.pelvis_pose import PelvisPose
from atlas_drake.units import Meters, Radians

PERIOD = 6.0
"""Duration of each movement [s]."""


@dataclass(frozen=True)
class DemoMovements(Configuration):
    """Amplitudes of the demo's movements, in their order.

    The height dips to one side, all others sway to both.
    """

    height: NotNegative[Meters] = 0.10
    """Down."""
    yaw: NotNegative[Radians] = 0.12
    """To either side."""
    pitch: NotNegative[Radians] = 0.20
    """Forward and back."""
    roll: NotNegative[Radians] = 0.15
    """To either side."""
    com_v0: NotNegative[Meters] = 0.06
    """Toward either foot."""
    com_v1: NotNegative[Meters] = 0.04
    """Forward and back."""


COORDINATES = tuple(field.name for field in fields(DemoMovements))
SWAY_GAIN = 1.54
"""Factor that scales the largest value of a sway to 1 [-]."""
_TRIALS = 60
"""Number of times in one round at which the reach of the legs is checked."""
_SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of the whole movement to try, largest first [-]."""


def demo_pose(
    home: PelvisPose, movements: DemoMovements, share: float, time: float
) -> PelvisPose:
    """Computes the pose of the demo about ``home``, ``share`` of the whole movement."""
    index, phase = divmod(time / PERIOD, 1.0)
    name = COORDINATES[int(index) % len(COORDINATES)]
    size = getattr(movements, name)
    # Begins and ends at rest.
    dip = 0.5 - 0.5 * math.cos(math.tau * phase)
    wave = -dip if name == "height" else SWAY_GAIN * dip * math.sin(math.tau * phase)
    return home._replace(**{name: getattr(home, name) + share * size * wave})


def demo_amplitude(
    home: PelvisPose, movements: DemoMovements, allows: Callable[[PelvisPose], bool]
) -> float:
    """Finds the largest share of the movement whose poses are all possible, or 0."""
    round_time = PERIOD * len(COORDINATES)
    times = [round_time * i / _TRIALS for i in range(_TRIALS)]
    for share in _SHARES:
        if all(allows(demo_pose(home, movements, share, time)) for time in times):
            return share
    return 0.0
