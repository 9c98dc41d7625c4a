"""The steps of a demonstration walk: straight ahead, at a comfortable pace."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from atlas_drake.control.feet.footstep import outward
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.planning.footholds import Gait
from atlas_drake.rotations import mean_yaw

DEMO_STEPS = 25
"""Index of the demonstration's last step. No setting: other walks are commanded."""


def demo_steps(
    feet: Sequence[FootPose], first_index: int, foot: int, gait: Gait
) -> tuple[Footstep, ...]:
    """Plans steps straight ahead; the last step puts the feet side by side."""
    yaw = mean_yaw(feet[0].yaw, feet[1].yaw)
    ahead = np.array([math.cos(yaw), math.sin(yaw)])
    left = np.array([-ahead[1], ahead[0]])
    middle = 0.5 * (feet[0].p_WF[:2] + feet[1].p_WF[:2])
    steps = []
    for index in range(first_index, DEMO_STEPS + 1):
        if index < DEMO_STEPS:
            middle = middle + gait.stride * ahead
        place = middle + outward(foot) * gait.half_width * left
        steps.append(
            Footstep(
                index=index,
                foot=foot,
                p_WF=np.append(place, 0.0),
                yaw=yaw,
                duration=gait.duration,
                swing_height=gait.swing_height,
                relative=True,
            )
        )
        foot = 1 - foot
    return tuple(steps)
