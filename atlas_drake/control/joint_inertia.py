"""How little inertia a joint can feel: what the joint PID's damping relies on.

Computed once per robot from the model; used by ``joint_pid``.
"""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.robot import Robot

_POSES = 100
"""Random poses looked at besides the stand-prep pose.

With 20 the poses that leave a hip the least inertia were missed, and D exceeded M by
half; from 50 on D ≤ M has held at every other pose tried.
"""


def lower_joint_inertia(robot: Robot) -> np.ndarray:
    """Diagonal D ≤ M(q): a joint inertia that the robot never undercuts [kg·m²].

    M is the joint-space inertia with the pelvis and all other joints free. For each of
    a fixed set of poses D = diag(1 / (M⁻¹)ᵢᵢ) / λ, with λ the largest eigenvalue of
    M⁻¹ scaled to a unit diagonal, so that D ≤ M there; the least of all poses counts.
    Contact with the ground only adds to what a joint feels.

    Returns:
        Shape (n,), message order.
    """
    plant = MultibodyPlant(time_step=0.0)
    robot.add_to(plant)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    indices = robot.indices(plant)
    random = np.random.default_rng(0)
    span = robot.position_upper - robot.position_lower
    poses = [robot.stand_prep] + [
        robot.position_lower + random.uniform(size=robot.num_joints) * span
        for _ in range(_POSES)
    ]
    least = np.full(robot.num_joints, np.inf)
    q = plant.GetPositions(context)
    for pose in poses:
        q[indices.q] = pose
        plant.SetPositions(context, q)
        inverse = np.linalg.inv(plant.CalcMassMatrix(context))[
            np.ix_(indices.v, indices.v)
        ]
        scale = 1.0 / np.sqrt(np.diag(inverse))
        largest = np.linalg.eigvalsh(inverse * np.outer(scale, scale))[-1]
        least = np.minimum(least, scale**2 / largest)
    return least
