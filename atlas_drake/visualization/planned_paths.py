"""What a behaviour has in mind, as points: support polygon, CoM, DCM and swing paths.

Reads what behaviours remember; draws nothing.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from atlas_drake.behaviors.manipulate.manipulate import ManipulateMemory
from atlas_drake.behaviors.stand.stand import StandMemory
from atlas_drake.behaviors.step.memory import StepMemory
from atlas_drake.behaviors.walk.memory import WalkMemory
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.swing_foot import SwingProfile, advance_swing, begin_swing

TIME_STEP = 0.04
"""Between the points of a path [s]."""


class PlannedPaths(NamedTuple):
    """Paths over the ground in W [m], each of shape (number of points, 2)."""

    com: np.ndarray
    dcm: np.ndarray


def support_of(memory: Any) -> SupportPolygon | None:
    """Where a behaviour believes that the CoP may lie; None if it does not care."""
    if isinstance(memory, ManipulateMemory):
        return memory.stance.support
    if isinstance(memory, StandMemory | WalkMemory | StepMemory):
        return memory.support
    return None


def planned_paths(memory: Any, com: np.ndarray, omega: float) -> PlannedPaths | None:
    """The rest of the plan from now on; None where there is none.

    Args:
        memory: Of the active behaviour.
        com: Where the centre of mass is, horizontal in W [m], shape (2,).
        omega: Natural frequency of the pendulum [1/s].
    """
    if isinstance(memory, WalkMemory):
        return _walk_paths(memory, com)
    if isinstance(memory, StepMemory) and not memory.in_air:
        sway, begin = memory.sway, memory.sway_time
        times = np.arange(begin, sway.duration, TIME_STEP)
        if times.size < 2:
            return None
        return PlannedPaths(
            com=np.array([sway.motion(t)[0] for t in times]),
            dcm=np.array([sway.evaluate(t, omega).dcm for t in times]),
        )
    return None


def _walk_paths(memory: WalkMemory, com: np.ndarray) -> PlannedPaths | None:
    """The CoM follows the DCM: ċ = ω (ξ - c), exactly for a DCM that stays."""
    plan = memory.plan
    times = np.arange(memory.plan_time, plan.duration, TIME_STEP)
    if times.size < 2:
        return None
    dcm = np.array([plan.evaluate(t).dcm for t in times])
    decay = np.exp(-plan.omega * TIME_STEP)
    path = [np.asarray(com, dtype=float)]
    for before, after in pairwise(dcm):
        goal = 0.5 * (before + after)
        path.append(goal + decay * (path[-1] - goal))
    return PlannedPaths(com=np.array(path), dcm=dcm)


def swing_path(memory: Any) -> np.ndarray | None:
    """Path of the sole in the air from lift-off to landing in W [m], shape (k, 3)."""
    if isinstance(memory, WalkMemory) and memory.swing is not None:
        swing = begin_swing(memory.swing.start, memory.swing.duration)
        points = [swing.start.p_WF]
        while swing.remaining > 0.0:
            step = min(TIME_STEP, max(swing.remaining, 1e-6))
            swing, reference = advance_swing(swing, memory.step, SwingProfile(), step)
            points.append(reference.p_WF)
        return np.array(points)
    if isinstance(memory, StepMemory) and memory.in_air and memory.swing is not None:
        count = max(int(memory.swing.duration / TIME_STEP), 2)
        times = np.linspace(0.0, memory.swing.duration, count)
        return np.array([memory.swing.evaluate(t).p_WF for t in times])
    return None
