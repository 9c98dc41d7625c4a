"""What STEP intends: its DCM reference now, its weight shift, and its swing.

Only for viewers and logs; steps are planned in ``plan``.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.step.memory import StepMemory
from atlas_drake.messages.controller_status import Plan, PlannedPaths, PlannedStep

TIME_STEP = 0.04
"""Between two points of a path [s]."""


def step_plan(memory: StepMemory, omega: float) -> Plan:
    """The plan of STEP.

    Args:
        memory: After the last tick.
        omega: Natural frequency of the pendulum [1/s].
    """
    reference = memory.dcm_reference(omega)
    step = memory.taken if memory.in_air else None
    return Plan(
        support=memory.support.vertices,
        omega=omega,
        dcm_reference=reference.dcm,
        cop_reference=reference.cop,
        footsteps=()
        if step is None
        else (PlannedStep(step.foot, step.p_WF, step.yaw),),
        preview=lambda: _paths(memory, omega),
    )


def _paths(memory: StepMemory, omega: float) -> PlannedPaths:
    if memory.in_air:
        if memory.swing is None:
            return PlannedPaths()
        count = max(int(memory.swing.duration / TIME_STEP), 2)
        times = np.linspace(0.0, memory.swing.duration, count)
        swing = np.array([memory.swing.evaluate(t).p_WF for t in times])
        return PlannedPaths(swing=swing)
    shift = memory.sway
    times = np.arange(memory.sway_time, shift.duration, TIME_STEP)
    if times.size < 2:
        return PlannedPaths()
    references = [shift.evaluate(t, omega) for t in times]
    return PlannedPaths(
        com=np.array([shift.motion(t)[0] for t in times]),
        dcm=np.array([reference.dcm for reference in references]),
        cop=np.array([reference.cop for reference in references]),
    )
