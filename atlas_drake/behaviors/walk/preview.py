"""What WALK intends: its DCM reference now, and the paths that its plan leads to.

Only for viewers and logs; the plan itself is made in ``gait``.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from atlas_drake.behaviors.walk.memory import WalkMemory
from atlas_drake.control.feet.swing_foot import SwingProfile, advance_swing, begin_swing
from atlas_drake.messages.controller_status import Plan, PlannedPaths, PlannedStep

TIME_STEP = 0.04
"""Between two points of a path [s]."""


def walk_plan(memory: WalkMemory, com: np.ndarray) -> Plan:
    """The plan of a walk.

    Args:
        memory: After the last tick.
        com: Center of mass at that tick, horizontal in W [m], shape (2,).
    """
    reference = memory.dcm_reference()
    current = [memory.step] if memory.swinging else []
    return Plan(
        support=memory.support.vertices,
        omega=memory.omega,
        dcm_reference=reference.dcm,
        cop_reference=reference.cop,
        footsteps=tuple(
            PlannedStep(step.foot, step.p_WF, step.yaw)
            for step in (*current, *memory.known)
        ),
        preview=lambda: _paths(memory, com),
    )


def _paths(memory: WalkMemory, com: np.ndarray) -> PlannedPaths:
    """Integrates ċ = ω (ξ - c), exactly for a DCM that stays between two points."""
    swing = _swing_path(memory)
    plan = memory.plan
    times = np.arange(memory.plan_time, plan.duration, TIME_STEP)
    if times.size < 2:
        return PlannedPaths(swing=swing)
    references = [plan.evaluate(t) for t in times]
    dcm = np.array([reference.dcm for reference in references])
    decay = np.exp(-plan.omega * TIME_STEP)
    path = [np.asarray(com, dtype=float)]
    for before, after in pairwise(dcm):
        goal = 0.5 * (before + after)
        path.append(goal + decay * (path[-1] - goal))
    cop = np.array([reference.cop for reference in references])
    return PlannedPaths(com=np.array(path), dcm=dcm, cop=cop, swing=swing)


def _swing_path(memory: WalkMemory) -> np.ndarray | None:
    """The sole in the air, from lift-off to touchdown in W [m], shape (k, 3)."""
    if memory.swing is None:
        return None
    swing = begin_swing(memory.swing.start, memory.swing.duration)
    points = [swing.start.p_WF]
    while swing.remaining > 0.0:
        step = min(TIME_STEP, max(swing.remaining, 1e-6))
        swing, reference = advance_swing(swing, memory.step, SwingProfile(), step)
        points.append(reference.p_WF)
    return np.array(points)
