"""What a robot that falls does with its motors: sag, and break its fall a little.

A law of one line; when the robot counts as falling is the behaviors' business.
"""

from __future__ import annotations

import numpy as np

DAMPING_PER_EFFORT = 0.002
"""Damping of a joint in damping mode per unit of its effort limit [s/rad].

A joint that turns at 10 rad/s is braked by a fiftieth of what its motor can do: limbs
do not whip, and nothing is pushed hard against the ground. Damping that is held over a
control tick has to stay well below twice a joint's inertia per tick, which for the
ankles in the air (0.009 kg·m², 700 N·m) is 0.013 at 2 ms.
"""


def damping_effort(v: np.ndarray, effort_limit: np.ndarray) -> np.ndarray:
    """Damping and nothing else [N·m], shape (n,).

    Args:
        v: Joint velocities [rad/s], shape (n,).
        effort_limit: [N·m], shape (n,).
    """
    effort = -DAMPING_PER_EFFORT * effort_limit * v
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)
