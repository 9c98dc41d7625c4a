"""The constrained inverse mass matrix, which the joint PID's implicit damping needs.

A model evaluation only; the law that uses the matrix is in ``joint_pid``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot

REGULARIZATION = 1e-6
"""Inverse mass [1/kg; 1/(kg·m²)] below which a constraint counts as dependent."""


class ConstrainedInverseMass:
    """The joints' block of M⁻¹, the pelvis free. Holds no state."""

    def __init__(self, robot: Robot):
        """Builds a separate plant without geometry."""
        # Untyped, because pydrake's stubs misname the type of every array.
        self._plant: Any = robot.make_plant()
        indices = robot.indices(self._plant)
        self._block = np.ix_(indices.v, indices.v)
        self._soles = [
            self._plant.GetFrameByName(foot.sole_frame) for foot in robot.file.feet
        ]

    def create_context(self) -> Context:
        """Creates a scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(
        self, context: Context, positions: np.ndarray, planted: Sequence[bool]
    ) -> np.ndarray:
        """Computes the joint accelerations per effort Λ [rad/s² per N·m], shape (n, n).

        A planted sole does not move: with N the projection on the motions that keep it
        in place, Λ = N·M⁻¹. A leg on the ground yields far less than a leg in the air.

        Args:
            context: A scratch context; overwritten.
            positions: Positions of the plant, in plant order.
            planted: True for the left and the right sole if the ground holds it.
        """
        plant = self._plant
        plant.SetPositions(context, positions)
        inverse_mass = np.linalg.inv(plant.CalcMassMatrix(context))
        world = plant.world_frame()
        soles = [sole for sole, held in zip(self._soles, planted, strict=True) if held]
        if soles:
            J = np.concatenate(
                [
                    plant.CalcJacobianSpatialVelocity(
                        context,
                        JacobianWrtVariable.kV,
                        sole,
                        np.zeros(3),
                        world,
                        world,
                    )
                    for sole in soles
                ]
            )
            to_soles = J @ inverse_mass
            # Both feet on the ground and a straight knee leave less than twelve
            # independent constraints.
            held = to_soles @ J.T + REGULARIZATION * np.eye(len(J))
            inverse_mass = inverse_mass - to_soles.T @ np.linalg.solve(held, to_soles)
        return inverse_mass[self._block]
