"""The camera, and ground, grid and light, that follow the robot.

Appearance of the scene is in ``scene``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context

from atlas_drake.visualization.display import Display, declare_values
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import center_at, look_at

LAG = 0.7
"""Time constant of the camera, so that it does not sway with the steps [s]."""
LEAST_MOVE = 0.05
"""Distance of the pelvis over the ground after which the scene moves [m]."""


class Following(Display):
    """Moves the scene with the pelvis over the ground, and the camera if asked to.

    While the camera follows, the mouse cannot turn the view. In a recording, which
    cannot hold the motion of the light, the scene stays where the robot begins.

    Input ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(
        self, meshcat: Meshcat, overlays: Overlays, period: float, recorded: bool
    ) -> None:
        """Looks at the robot every ``period`` [s]; ``recorded`` as in ``Marks``."""
        super().__init__(period)
        self._meshcat = meshcat
        self._overlays = overlays
        self._recorded = recorded
        (self._report,) = declare_values(self, "atlas_sim_interface_state")
        self._share = 1.0 - math.exp(-period / LAG)
        self._scene: tuple[float, float] | None = None
        self._target: np.ndarray | None = None

    def _publish(self, context: Context) -> None:
        report: Any = self._report.Eval(context)
        x, y, _ = map(float, report.pos_est.position.to_array())
        if self._scene is None or (
            not self._recorded and math.dist((x, y), self._scene) > LEAST_MOVE
        ):
            self._scene = x, y
            center_at(self._meshcat, x, y)
        if self._overlays.is_on("follow"):
            ground = min(foot.position.z for foot in report.foot_pos_est)
            goal = np.array([x, y, ground])
            target = goal if self._target is None else self._target
            self._target = target + self._share * (goal - target)
            look_at(self._meshcat, self._target)
