"""The cost of the whole-body QP: weighted errors of tasks as Hessian and gradient."""

from __future__ import annotations

import numpy as np

from atlas_drake.control.whole_body.contact import WRENCH
from atlas_drake.control.whole_body.elimination import ReducedDynamics, TaskStack
from atlas_drake.control.whole_body.tasks import PostureTask


def cost(
    dynamics: ReducedDynamics, stack: TaskStack, posture: PostureTask
) -> tuple[np.ndarray, np.ndarray]:
    """Adds up ½ ‖error‖²_weight of all tasks, and the cost of the contact wrenches.

    Args:
        dynamics: Dynamics of the tick, reduced together with the stack.
        stack: All tasks but the posture.
        posture: The posture task, whose weights go on the diagonal.

    Returns:
        Hessian H ∈ R^{size × size} and gradient f ∈ R^{size} at z = 0.
    """
    n, size = dynamics.num_joints, dynamics.size
    rows = dynamics.tasks
    R = rows[:, :size]
    weighted = R.T * stack.weight
    H = weighted @ R
    f = weighted @ (rows[:, size] - stack.target)
    diagonal = np.empty(size)
    diagonal[:n] = posture.weight
    for k, contact in enumerate(dynamics.contacts):
        start = n + WRENCH * k
        diagonal[start : start + 3] = contact.moment_weight
        diagonal[start + 3 : start + 6] = contact.force_weight
    H.reshape(-1)[:: size + 1] += diagonal
    f[:n] -= posture.weight * posture.target
    return H, f
