"""Joint damping for a falling robot: the joints sag and absorb a part of the impact.

This module holds the law only; the behaviors detect a fall.
"""

from __future__ import annotations

import numpy as np

DAMPING_PER_EFFORT = 0.002
"""Damping of a joint in damping mode per unit of its effort limit [s/rad].

A joint that turns at 10 rad/s is braked with a fiftieth of its effort limit: limbs do
not whip, and nothing is pushed hard against the ground. Damping that is constant over a
control tick must stay well below twice a joint's inertia per tick, which for the ankles
in the air (0.009 kg·m², 700 N·m) is 0.0064 at 4 ms.
"""


def damping_effort(v: np.ndarray, effort_limit: np.ndarray) -> np.ndarray:
    """Computes the effort of pure damping [N·m], shape (n,).

    Args:
        v: Joint velocities [rad/s], shape (n,).
        effort_limit: Effort limits [N·m], shape (n,).
    """
    effort = -DAMPING_PER_EFFORT * effort_limit * v
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)
