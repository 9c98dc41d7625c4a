"""The steps of a walk: those of a message, or those of the demo walk.

Pure functions; the phases of the walk determine the timing.
"""

from __future__ import annotations

from collections.abc import Sequence

from atlas_drake.behaviors.step_queue import merge
from atlas_drake.behaviors.walk.phases import WalkProgress
from atlas_drake.control.feet.footstep import (
    LEFT,
    FootPose,
    Footstep,
)
from atlas_drake.messages import AtlasBehaviorWalkParams
from atlas_drake.planning.demo_steps import demo_steps
from atlas_drake.planning.footholds import Gait


def steps_asked_for(
    pending: tuple[Footstep, ...],
    params: AtlasBehaviorWalkParams,
    feet: Sequence[FootPose],
    first_open: int,
    gait: Gait,
    last_foot: int | None = None,
) -> tuple[Footstep, ...]:
    """Returns the coming steps after a message.

    Args:
        pending: Earlier steps that have not begun.
        params: Parameters of the message.
        feet: Poses of the soles; landing pose of a foot in the air.
        first_open: Lowest index that has not begun.
        gait: Gait of the demo walk.
        last_foot: The foot of the present or last step, if any.
    """
    if params.use_demo_walk:
        foot = LEFT if last_foot is None else 1 - last_foot
        return demo_steps(feet, first_open, foot, gait)
    return merge(
        pending, params.step_queue, first_open, params.use_relative_step_height
    )


def feet_to_come(progress: WalkProgress, in_air: Footstep | None) -> list[FootPose]:
    """Returns the poses of the soles, with the landing pose of a foot in the air.

    Args:
        progress: WalkProgress of the walk.
        in_air: The step whose foot is in the air, if any.
    """
    feet = list(progress.feet)
    if in_air is not None:
        feet[in_air.foot] = in_air.pose
    return feet
