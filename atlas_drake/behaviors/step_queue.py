"""The queue of coming steps of WALK and STEP, merged from messages.

Order and indices only; reach and relative heights are resolved from the stance foot of
each step.
"""

from __future__ import annotations

import numpy as np
from pydrake.math import RotationMatrix

from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.control.feet.footstep import Footstep
from atlas_drake.control.rotations import yaw_of
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData, Quaternion, Vector3


def footstep_from(data: AtlasBehaviorStepData, relative: bool = False) -> Footstep:
    """Converts a message to a step with the pose of the sole frame in W.

    Args:
        data: The message.
        relative: True if its height counts from the stance foot.
    """
    p = data.pose.position
    quaternion = data.pose.orientation.to_wxyz()
    R_WF = rotation_matrix(quaternion / np.linalg.norm(quaternion))
    return Footstep(
        index=int(data.step_index),
        foot=int(data.foot_index),
        p_WF=np.array([p.x, p.y, p.z], dtype=float),
        yaw=yaw_of(R_WF),
        duration=float(data.duration),
        swing_height=float(data.swing_height),
        normal=R_WF[:, 2],
        relative=relative,
    )


def step_data_from(step: Footstep) -> AtlasBehaviorStepData:
    """Converts a step to its message."""
    data = AtlasBehaviorStepData()
    data.step_index = step.index
    data.foot_index = step.foot
    data.duration = step.duration
    data.swing_height = step.swing_height
    data.pose.position = Vector3.from_array(step.p_WF)
    quaternion = RotationMatrix(step.pose.R_WF).ToQuaternion()
    data.pose.orientation = Quaternion.from_wxyz(quaternion.wxyz())
    return data


def merge(
    pending: tuple[Footstep, ...],
    sent: list[AtlasBehaviorStepData],
    first_open: int,
    relative: bool = False,
) -> tuple[Footstep, ...]:
    """Merges a message into the coming steps: it replaces steps that have not begun.

    Args:
        pending: Earlier steps that have not begun.
        sent: The message's queue.
        first_open: Lowest index that has not begun; lower ones are ignored.
        relative: True if heights in the message count from the stance foot.
    """
    steps = {step.index: step for step in pending}
    for data in sent:
        if data.step_index != NO_STEP and data.step_index >= first_open:
            step = footstep_from(data, relative)
            steps[step.index] = step
    return tuple(steps[index] for index in sorted(steps))


def replaced(
    before: tuple[Footstep, ...], after: tuple[Footstep, ...]
) -> frozenset[int]:
    """Returns the indices of the steps in ``after`` that differ from ``before``."""
    known = {step.index: _content(step) for step in before}
    return frozenset(s.index for s in after if known.get(s.index) != _content(s))


def _content(step: Footstep) -> tuple[float, ...]:
    """Returns all values of a step from its message, for comparison."""
    return (
        step.foot,
        *step.p_WF.tolist(),
        step.yaw,
        step.duration,
        step.swing_height,
        *step.normal.tolist(),
        step.relative,
    )


def next_runs(pending: tuple[Footstep, ...], index: int) -> tuple[Footstep, ...]:
    """Returns the steps from ``index`` on without a gap in their indices."""
    run: list[Footstep] = []
    for step in pending:
        if step.index == index + len(run):
            run.append(step)
    return tuple(run)
