"""The plan of WALK for viewers and logs: present references and future paths.

The DCM plan itself is made in ``gait``.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from atlas_drake.behaviors.walk.phases import WalkState, WalkSwing
from atlas_drake.control.feet.swing_foot import SwingProfile, advance_swing, begin_swing
from atlas_drake.messages.controller_status import Plan, PlannedPaths, PlannedStep

TIME_STEP = 0.04
"""Time between two points of a path [s]."""


def walk_plan(phase: WalkState) -> Plan:
    """Returns the plan of a walk for the phase after the last tick."""
    reference = phase.dcm_reference()
    in_air = phase.in_air
    current = () if in_air is None else (in_air,)
    return Plan(
        support=phase.support.vertices,
        omega=phase.plan.omega,
        dcm_reference=reference.dcm,
        cop_reference=reference.cop,
        footsteps=tuple(
            PlannedStep(step.foot, step.p_WF, step.yaw)
            for step in (*current, *phase.progress.known)
        ),
    )


def walk_paths(
    phase: WalkState, com: np.ndarray, profile: SwingProfile
) -> PlannedPaths:
    """Integrates ċ = ω (ξ - c), exactly for a constant DCM between two points.

    Args:
        phase: The phase after the last tick.
        com: Center of mass at that tick, horizontal in W [m], shape (2,).
        profile: Shape of the swing.
    """
    swing = _swing_path(phase, profile) if isinstance(phase, WalkSwing) else None
    plan = phase.plan
    times = np.arange(phase.plan_time, plan.duration, TIME_STEP)
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


def _swing_path(phase: WalkSwing, profile: SwingProfile) -> np.ndarray:
    """Samples the swing sole from lift-off to touchdown in W [m], shape (k, 3)."""
    swing = begin_swing(phase.motion.start, phase.motion.duration)
    points = [swing.start.p_WF]
    while swing.remaining > 0.0:
        step = min(TIME_STEP, max(swing.remaining, 1e-6))
        swing, reference = advance_swing(swing, phase.step, profile, step)
        points.append(reference.p_WF)
    return np.array(points)
