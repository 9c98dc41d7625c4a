"""The steps of a demonstration walk: straight ahead, at a comfortable pace."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from atlas_drake.control.feet.footstep import FootPose, Footstep, outward
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.planning.footholds import HALF_WIDTH

DEMO_STEPS = 25
"""Index of the demonstration's last step."""
DEMO_LENGTH = 0.20
"""Length of each step [m]."""
DEMO_DURATION = 0.63
"""Duration of each step [s]."""
DEMO_SWING_HEIGHT = 0.10
"""[m]"""


def demo_steps(
    feet: Sequence[FootPose], first_index: int, foot: int
) -> tuple[Footstep, ...]:
    """Straight ahead from where the feet are; the last step puts them side by side.

    Args:
        feet: Left and right sole.
        first_index: Of the first step.
        foot: Of the first step.
    """
    yaw = mean_yaw(feet[0].yaw, feet[1].yaw)
    ahead = np.array([math.cos(yaw), math.sin(yaw)])
    left = np.array([-ahead[1], ahead[0]])
    middle = 0.5 * (feet[0].p_WF[:2] + feet[1].p_WF[:2])
    steps = []
    for index in range(first_index, DEMO_STEPS + 1):
        if index < DEMO_STEPS:
            middle = middle + DEMO_LENGTH * ahead
        place = middle + outward(foot) * HALF_WIDTH * left
        steps.append(
            Footstep(
                index=index,
                foot=foot,
                p_WF=np.append(place, 0.0),
                yaw=yaw,
                duration=DEMO_DURATION,
                swing_height=DEMO_SWING_HEIGHT,
                relative=True,
            )
        )
        foot = 1 - foot
    return tuple(steps)
