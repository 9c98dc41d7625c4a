"""The steps that a walk still has to take, merged from the messages that bring them.

Order and indices only; whether a step can be reached is decided when it begins.
"""

from __future__ import annotations

import numpy as np
from pydrake.math import RotationMatrix

from atlas_drake.control.footstep import Footstep
from atlas_drake.control.rotations import yaw_of
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData


def footstep_from(data: AtlasBehaviorStepData) -> Footstep:
    """The step that a message describes, its pose that of the sole frame in W."""
    p = data.pose.position
    quaternion = data.pose.orientation.to_wxyz()
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    x_axis = np.array([[1.0 - 2.0 * (y * y + z * z)], [2.0 * (x * y + w * z)]])
    z_axis = [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)]
    return Footstep(
        index=int(data.step_index),
        foot=int(data.foot_index),
        p_WF=np.array([p.x, p.y, p.z], dtype=float),
        yaw=yaw_of(x_axis),
        duration=float(data.duration),
        swing_height=float(data.swing_height),
        normal=np.array(z_axis),
    )


def step_data_from(step: Footstep) -> AtlasBehaviorStepData:
    """The message's form of a step."""
    data = AtlasBehaviorStepData()
    data.step_index = step.index
    data.foot_index = step.foot
    data.duration = step.duration
    data.swing_height = step.swing_height
    position, orientation = data.pose.position, data.pose.orientation
    position.x, position.y, position.z = map(float, step.p_WF)
    wxyz = RotationMatrix(step.pose.R_WF).ToQuaternion().wxyz()
    orientation.w, orientation.x, orientation.y, orientation.z = map(float, wxyz)
    return data


def merge(
    pending: tuple[Footstep, ...],
    sent: list[AtlasBehaviorStepData],
    first_open: int,
) -> tuple[Footstep, ...]:
    """Steps to come after a message: later news replaces what has not begun.

    Args:
        pending: Steps known so far that have not begun.
        sent: The message's queue.
        first_open: Lowest index that has not begun; older ones are ignored.
    """
    steps = {step.index: step for step in pending}
    for data in sent:
        if data.step_index != NO_STEP and data.step_index >= first_open:
            step = footstep_from(data)
            steps[step.index] = step
    return tuple(steps[index] for index in sorted(steps))


def next_runs(pending: tuple[Footstep, ...], index: int) -> tuple[Footstep, ...]:
    """The steps that follow each other without a gap from ``index`` on."""
    run: list[Footstep] = []
    for step in pending:
        if step.index == index + len(run):
            run.append(step)
    return tuple(run)


def alternating(steps: tuple[Footstep, ...], last_foot: int | None) -> bool:
    """Whether left and right take turns, beginning after ``last_foot``."""
    for step in steps:
        if step.foot == last_foot:
            return False
        last_foot = step.foot
    return True
