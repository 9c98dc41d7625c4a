"""A camera that follows the robot.

While it is switched on the mouse cannot turn the view.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context

from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import look_at

LAG = 0.7
"""Time constant of the camera, so that it does not sway with the steps [s]."""


class FollowingCamera(Display):
    """Moves the camera with the pelvis over the ground while it is switched on.

    Input ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, overlays: Overlays, period: float) -> None:
        """Updates the view every ``period`` [s]."""
        super().__init__(period)
        self._meshcat = meshcat
        self._overlays = overlays
        self._report = self.DeclareAbstractInputPort(
            "atlas_sim_interface_state", AbstractValue.Make(AtlasSimInterfaceState())
        )
        self._share = 1.0 - math.exp(-period / LAG)
        self._place: np.ndarray | None = None

    def _publish(self, context: Context) -> None:
        if not self._overlays.is_on("follow"):
            return
        report: Any = self._report.Eval(context)
        pelvis = report.pos_est.position
        ground = min(foot.position.z for foot in report.foot_pos_est)
        goal = np.array([pelvis.x, pelvis.y, ground])
        place = goal if self._place is None else self._place
        self._place = place + self._share * (goal - place)
        look_at(self._meshcat, self._place)
