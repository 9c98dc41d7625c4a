"""How far each joint gives way to efforts: what the joint PID's damping relies on.

A model evaluation only; the law that uses it is ``joint_pid``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot


class JointMobility:
    """The joints' block of M⁻¹, pelvis and all joints free. Holds no state."""

    def __init__(self, robot: Robot):
        """Builds a plant of its own without geometry."""
        # Untyped, because pydrake's stubs misname the type of every array.
        self._plant: Any = MultibodyPlant(time_step=0.0)
        robot.add_to(self._plant)
        self._plant.Finalize()
        indices = robot.indices(self._plant)
        self._block = np.ix_(indices.v, indices.v)

    def create_context(self) -> Context:
        """A scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(self, context: Context, positions: np.ndarray) -> np.ndarray:
        """Joint accelerations per effort Λ [rad/s² per N·m], shape (n, n).

        Args:
            context: A scratch context; overwritten.
            positions: Of the plant, in plant order.
        """
        self._plant.SetPositions(context, positions)
        return np.linalg.inv(self._plant.CalcMassMatrix(context))[self._block]
