"""Joint damping for a falling robot: the joints sag and absorb a part of the impact.

This module holds the law only; the behaviors detect a fall.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.joints.blend import limited

DAMPING_PER_EFFORT = 0.002
"""Damping of a joint in damping mode per unit of its effort limit [s/rad].

No setting: a falling robot protects itself, and only the order of magnitude counts. A
joint that turns at 10 rad/s is braked with a fiftieth of its effort limit: limbs do
not whip, and nothing is pushed hard against the ground.
"""
DAMPING_PER_TICK = 8e-6
"""Largest damping per unit of the effort limit, times the control period [s²/rad].

A bound of stability: damping that is constant over a control tick must stay well below
twice the inertia per tick. The least inertia for an effort limit is that of the ankles
in the air (0.009 kg·m², 700 N·m): 1.3e-5.
"""


def damping_mode_gain(effort_limit: np.ndarray, period: float) -> np.ndarray:
    """Computes each joint's damping [N·m·s/rad] for efforts held for ``period`` [s]."""
    return min(DAMPING_PER_EFFORT, DAMPING_PER_TICK / period) * effort_limit


def damping_effort(
    v: np.ndarray, effort_limit: np.ndarray, period: float
) -> np.ndarray:
    """Computes the effort of pure damping [N·m], (n,), held for ``period`` [s]."""
    effort = -damping_mode_gain(effort_limit, period) * v
    return limited(effort, effort_limit)
