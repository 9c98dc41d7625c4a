"""The plan of STEP for viewers and logs: DCM reference, weight shift and swing.

Steps are planned in ``plan``.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.step.phases import StepState
from atlas_drake.messages.controller_status import Plan, PlannedPaths, PlannedStep

TIME_STEP = 0.04
"""Time between two points of a path [s]."""


def step_plan(phase: StepState, omega: float) -> Plan:
    """Returns the plan of STEP.

    Args:
        phase: The phase after the last tick.
        omega: Natural frequency of the pendulum [1/s].
    """
    reference = phase.dcm_reference(omega)
    in_air = phase.in_air
    steps = () if in_air is None else (in_air.step,)
    return Plan(
        support=phase.support.vertices,
        omega=omega,
        dcm_reference=reference.dcm,
        cop_reference=reference.cop,
        footsteps=tuple(PlannedStep(step.foot, step.p_WF, step.yaw) for step in steps),
    )


def step_paths(phase: StepState, omega: float) -> PlannedPaths:
    """Returns the path of the swing foot, or those of the weight shift.

    Args:
        phase: The phase after the last tick.
        omega: Natural frequency of the pendulum [1/s].
    """
    if phase.in_air is not None:
        swing = phase.in_air.swing
        count = max(int(swing.duration / TIME_STEP), 2)
        times = np.linspace(0.0, swing.duration, count)
        return PlannedPaths(swing=np.array([swing.evaluate(t).p_WF for t in times]))
    shift = phase.shift
    times = np.arange(phase.shift_time, shift.duration, TIME_STEP)
    if times.size < 2:
        return PlannedPaths()
    references = [shift.evaluate(t, omega) for t in times]
    return PlannedPaths(
        com=np.array([shift.motion(t)[0] for t in times]),
        dcm=np.array([reference.dcm for reference in references]),
        cop=np.array([reference.cop for reference in references]),
    )
