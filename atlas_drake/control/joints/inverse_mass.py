"""The inverse mass matrix, which the joint PID's implicit damping needs.

A model evaluation only; the law that uses the matrix is in ``joint_pid``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot


class InverseMass:
    """The joints' block of M⁻¹, the pelvis free and no sole on the ground.

    The ground makes joints heavier than they are here, never lighter, and the law
    tolerates that. It holds no state.
    """

    def __init__(self, robot: Robot):
        """Builds a separate plant without geometry."""
        # Untyped, because pydrake's stubs misname the type of every array.
        self._plant: Any = robot.make_plant()
        indices = robot.indices(self._plant)
        self._block = np.ix_(indices.v, indices.v)

    def create_context(self) -> Context:
        """Creates a scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(self, context: Context, positions: np.ndarray) -> np.ndarray:
        """Computes the joint accelerations per effort Λ [rad/s² per N·m], shape (n, n).

        Args:
            context: A scratch context; overwritten.
            positions: Positions of the plant, in plant order.
        """
        self._plant.SetPositions(context, positions)
        return np.linalg.inv(self._plant.CalcMassMatrix(context))[self._block]
