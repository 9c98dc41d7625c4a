"""Pure parts of a log's row: what the behaviours report, and the CoP.

Which ports they come from is in ``recorder``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from atlas_drake.behaviors.step_queue import footstep_from
from atlas_drake.logs.layout import SIDES, STEP_FIELDS
from atlas_drake.messages import NO_STEP, AtlasSimInterfaceState

LEAST_LOAD = 20.0
"""Vertical force on both soles together below which there is no CoP [N]."""


def centre_of_pressure(
    soles: Sequence[np.ndarray], wrenches: np.ndarray
) -> np.ndarray | None:
    """Where the ground's force acts on both soles together.

    Args:
        soles: Positions of the soles' centres in W [m].
        wrenches: Moment and force on each, at its centre in W [N·m; N], shape (12,).

    Returns:
        Horizontal position in W [m], shape (2,); None without enough load.
    """
    total, moment = 0.0, np.zeros(2)
    for sole, wrench in zip(soles, wrenches.reshape(2, 6), strict=True):
        load = wrench[5]
        total += load
        moment += load * sole[:2] + np.array([-wrench[1], wrench[0]])
    return moment / total if total > LEAST_LOAD else None


def reported(report: AtlasSimInterfaceState) -> dict[str, Any]:
    """Values of the channels that hold what the behaviours report, by name."""
    feedback = report.behavior_feedback
    walk, step = report.walk_feedback, report.step_feedback
    values: dict[str, Any] = {
        "behavior.current": report.current_behavior,
        "behavior.desired": report.desired_behavior,
        "behavior.status_flags": feedback.status_flags,
        "behavior.trans_from": feedback.trans_from,
        "behavior.trans_to": feedback.trans_to,
        "behavior.error_code": report.error_code,
        "step.status_flags": step.status_flags,
        "step.t_step_rem": step.t_step_rem,
        "step.current_step_index": step.current_step_index,
        "step.next_step_index_needed": step.next_step_index_needed,
        "step.step": _steps([step.desired_step_saturated]),
        "walk.status_flags": walk.status_flags,
        "walk.t_step_rem": walk.t_step_rem,
        "walk.current_step_index": walk.current_step_index,
        "walk.next_step_index_needed": walk.next_step_index_needed,
        "walk.steps": _steps(walk.step_queue_saturated),
        "pelvis.position": report.pos_est.position.to_array(),
        "pelvis.velocity": report.pos_est.velocity.to_array(),
    }
    for side, pose in zip(SIDES, report.foot_pos_est, strict=True):
        values[f"feet.{side}_position"] = pose.position.to_array()
        values[f"feet.{side}_orientation"] = pose.orientation.to_wxyz()
    return values


def _steps(queue: Sequence[Any]) -> list[float]:
    numbers: list[float] = []
    for data in queue:
        if data.step_index == NO_STEP:
            numbers += [NO_STEP] + [0.0] * (len(STEP_FIELDS) - 1)
        else:
            step = footstep_from(data)
            numbers += [step.index, step.foot, *step.p_WF.tolist(), step.yaw]
    return numbers
