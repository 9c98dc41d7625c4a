"""Which steps a walk takes: those that a message asks for, or a demonstration's own.

Pure functions of what the walk remembers; when steps are taken is in ``walk``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from atlas_drake.behaviors.step_queue import merge
from atlas_drake.behaviors.walk_memory import WalkMemory
from atlas_drake.control.footstep import (
    LEFT,
    FootPose,
    Footstep,
    outward,
)
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.footholds import HALF_WIDTH
from atlas_drake.messages import AtlasBehaviorWalkParams

DEMO_STEPS = 25
"""Index of the demonstration's last step."""
DEMO_LENGTH = 0.20
"""Length of each step [m]."""
DEMO_DURATION = 0.63
"""Duration of each step [s]."""
DEMO_SWING_HEIGHT = 0.10
"""[m]"""


def steps_asked_for(
    pending: tuple[Footstep, ...],
    params: AtlasBehaviorWalkParams,
    feet: Sequence[FootPose],
    first_open: int,
    last_foot: int | None = None,
) -> tuple[Footstep, ...]:
    """Steps to come after a message.

    Args:
        pending: Steps known so far that have not begun.
        params: Of the message.
        feet: Where the soles are, one in the air where it will land.
        first_open: Lowest index that has not begun.
        last_foot: The foot that steps now or has stepped last, if any.
    """
    if params.use_demo_walk:
        foot = LEFT if last_foot is None else 1 - last_foot
        return demo_steps(feet, first_open, foot)
    return merge(
        pending, params.step_queue, first_open, params.use_relative_step_height
    )


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


def feet_to_come(memory: WalkMemory) -> list[FootPose]:
    """Where the soles are, one in the air where it will land."""
    feet = list(memory.feet)
    if memory.swinging:
        feet[memory.step.foot] = memory.step.pose
    return feet
