"""The steps that a walk still has to take, merged from the messages that bring them.

Order and indices only; whether a step can be reached, and what its height means, is
decided from the foot it is taken from.
"""

from __future__ import annotations

import numpy as np
from pydrake.math import RotationMatrix

from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.control.feet.footstep import Footstep
from atlas_drake.control.rotations import yaw_of
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData, Quaternion, Vector3


def footstep_from(data: AtlasBehaviorStepData, relative: bool = False) -> Footstep:
    """The step that a message describes, its pose that of the sole frame in W.

    Args:
        data: Of the message.
        relative: Whether its height counts from the stance foot.
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
    """The message's form of a step."""
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
    """Steps to come after a message: later news replaces what has not begun.

    Args:
        pending: Steps known so far that have not begun.
        sent: The message's queue.
        first_open: Lowest index that has not begun; older ones are ignored.
        relative: Whether heights in the message count from the stance foot.
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
    """Indices of the steps in ``after`` that are not as they were in ``before``."""
    known = {step.index: _content(step) for step in before}
    return frozenset(s.index for s in after if known.get(s.index) != _content(s))


def _content(step: Footstep) -> tuple[float, ...]:
    """All that a message said of a step, comparable."""
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
    """The steps that follow each other without a gap from ``index`` on."""
    run: list[Footstep] = []
    for step in pending:
        if step.index == index + len(run):
            run.append(step)
    return tuple(run)
