"""Footsteps from a direction, for WALK under teleoperation.

Pure functions of the direction, the gait and the latest report. ``driving`` calls them;
``commander`` reads the keys.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from atlas_drake.control.feet.footstep import LEFT, RIGHT, clip
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorStepData,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.planning.footholds import (
    SIDEWAYS_SHARE,
    Foothold,
    Gait,
    foothold,
    step_data,
    step_from,
)

ROUNDING = 1e-9
"""Tolerance for rounding of a number of steps [-]."""


class Direction(NamedTuple):
    """Direction of the walk: shares of the stride and of the turn per step, -1 to 1.

    Attributes:
        forward: Negative is backward.
        left: Negative is to the right.
        turn: Positive is to the left.
    """

    forward: float = 0.0
    left: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True)
class Walker:
    """State of one walk.

    Attributes:
        first_foot: Foot that takes step 1; feet alternate.
        strides: Forward share of each step that was sent [m], by step index.
        closing: Index of the step that puts the feet side by side; None while
            walking on.
    """

    first_foot: int
    strides: dict[int, float] = field(default_factory=dict)
    closing: int | None = None

    def foot(self, index: int) -> int:
        """Returns the foot that takes a step."""
        return self.first_foot if index % 2 else 1 - self.first_foot


def begin_walk(direction: Direction) -> Walker:
    """Makes a walk that begins with the foot on the side of the direction."""
    towards_right = direction.left < 0.0 or (not direction.left and direction.turn < 0)
    return Walker(first_foot=RIGHT if towards_right else LEFT)


def first_open_step(report: AtlasSimInterfaceState) -> int:
    """Returns the index of the first step that can still be changed safely.

    In single support it is the step after the present one. In double support the weight
    already shifts for the next step, so it is the step after that.
    """
    if report.current_behavior != Behavior.WALK:
        return 1
    walk = report.walk_feedback
    current = walk.current_step_index
    in_air = any(0 < step.step_index == current for step in walk.step_queue_saturated)
    return current + (1 if in_air else 2)


def next_steps(
    walker: Walker,
    direction: Direction,
    gait: Gait,
    report: AtlasSimInterfaceState,
) -> tuple[Walker, list[AtlasBehaviorStepData]]:
    """Plans the steps that can still be changed.

    Returns:
        The new state of the walk, and steps for the queue.
    """
    first = first_open_step(report)
    feet = feet_before(first, report)
    stride = walker.strides.get(first - 1, 0.0)
    strides = {i: s for i, s in walker.strides.items() if i < first}
    steps = []
    for index in range(first, first + NUM_REQUIRED_WALK_STEPS):
        foot = walker.foot(index)
        closed = walker.closing is not None and index >= walker.closing
        if closed:
            stride, shift, turn = 0.0, 0.0, 0.0
        else:
            longest = gait.stride if direction.forward > 0.0 else gait.backward_stride
            change = longest * direction.forward - stride
            stride += clip(change, -gait.stride_change, gait.stride_change)
            shift = gait.stride * SIDEWAYS_SHARE * direction.left
            turn = gait.turn * direction.turn
        feet[foot] = step_from(feet[1 - foot], foot, gait, stride, shift, turn)
        strides[index] = stride
        steps.append(step_data(index, foot, feet[foot], gait))
    return replace(walker, strides=strides), steps


def close_feet(walker: Walker, gait: Gait, report: AtlasSimInterfaceState) -> Walker:
    """Ends the walk: strides shrink until a step puts the feet side by side."""
    if walker.closing is not None:
        return walker
    first = first_open_step(report)
    stride = abs(walker.strides.get(first - 1, 0.0))
    shrinking = max(math.ceil(stride / gait.stride_change - ROUNDING) - 1, 0)
    return replace(walker, closing=first + shrinking)


def is_closing(walker: Walker, report: AtlasSimInterfaceState) -> bool:
    """Returns True once the last step has begun, so that STAND may be requested."""
    index = report.walk_feedback.current_step_index
    return walker.closing is not None and index >= walker.closing


def feet_before(index: int, report: AtlasSimInterfaceState) -> list[Foothold]:
    """Computes the poses of the feet when step ``index`` begins.

    Feet on the ground keep their poses; feet of earlier steps have the landing poses of
    the report.
    """
    feet = [foothold(pose) for pose in report.foot_pos_est]
    if report.current_behavior == Behavior.WALK:
        for step in report.walk_feedback.step_queue_saturated:
            if 0 < step.step_index < index:
                feet[step.foot_index] = foothold(step.pose)
    return feet
