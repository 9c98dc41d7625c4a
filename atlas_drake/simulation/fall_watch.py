"""Detects a fall from the true state, for any controller of the robot.

A controller may detect the fall earlier; then the controller's event counts.
"""

from __future__ import annotations

from typing import Any

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.behaviors.fall import FallLimits, Posture, sign_of_fall
from atlas_drake.robot import Robot


class FallWatch:
    """Detects a fall from the true state of a robot."""

    def __init__(self, robot: Robot, plant: MultibodyPlant, limits: FallLimits) -> None:
        """Watches ``robot`` in ``plant``, with the limits of the controller."""
        self._plant: Any = plant
        self._limits = limits
        own = robot.instance(plant)
        self._pelvis = plant.GetBodyByName(robot.file.pelvis, own)
        self._soles = [plant.GetFrameByName(f.sole_frame, own) for f in robot.file.feet]
        self._instances = [own]
        self._nominal_height = self._standing_height(robot) - robot.file.com_drop

    def sign(self, context: Context) -> str:
        """Describes the sign of a fall in the posture; empty if there is none.

        Args:
            context: Context of the plant.
        """
        X_WP = self._plant.EvalBodyPoseInWorld(context, self._pelvis)
        posture = Posture(
            upright=float(X_WP.rotation().matrix()[2, 2]),
            com_height=self._com_height(context),
        )
        return sign_of_fall(posture, self._nominal_height, self._limits)

    def _com_height(self, context: Context) -> float:
        """Computes the height of the center of mass above the lower sole [m]."""
        com = self._plant.CalcCenterOfMassPositionInWorld(context, self._instances)
        soles = [sole.CalcPoseInWorld(context).translation()[2] for sole in self._soles]
        return float(com[2] - min(soles))

    def _standing_height(self, robot: Robot) -> float:
        """Computes the height of the center of mass in the stand-prep pose [m]."""
        context = self._plant.CreateDefaultContext()
        q = self._plant.GetPositions(context, *self._instances)
        q[robot.indices(self._plant).q] = robot.stand_prep
        self._plant.SetPositions(context, *self._instances, q)
        return self._com_height(context)
