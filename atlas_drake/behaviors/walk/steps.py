"""Which steps a walk takes: those that a message asks for, or a demonstration's own.

Pure functions; when steps are taken is decided in the phases of the walk.
"""

from __future__ import annotations

from collections.abc import Sequence

from atlas_drake.behaviors.step.queue import merge
from atlas_drake.behaviors.walk.phases import Course
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
    """Steps to come after a message.

    Args:
        pending: Steps known so far that have not begun.
        params: Of the message.
        feet: Where the soles are, one in the air where it will land.
        first_open: Lowest index that has not begun.
        gait: Of a demonstration.
        last_foot: The foot that steps now or has stepped last, if any.
    """
    if params.use_demo_walk:
        foot = LEFT if last_foot is None else 1 - last_foot
        return demo_steps(feet, first_open, foot, gait)
    return merge(
        pending, params.step_queue, first_open, params.use_relative_step_height
    )


def feet_to_come(course: Course, in_air: Footstep | None) -> list[FootPose]:
    """Returns where the soles are, one in the air where it will land.

    Args:
        course: Of the walk.
        in_air: The step whose foot is in the air, if any.
    """
    feet = list(course.feet)
    if in_air is not None:
        feet[in_air.foot] = in_air.pose
    return feet
