"""Ground, grid and light that go with the robot.

Appearance of the scene is in ``scene``.
"""

from __future__ import annotations

import math
from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context

from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.scene import center_at

LEAST_MOVE = 0.05
"""Distance of the pelvis over the ground after which the scene moves [m]."""


class FollowingScene(Display):
    """Moves the scene with the pelvis over the ground.

    In a recording, which cannot hold the motion of the light, the scene stays where the
    robot begins.

    Input ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, period: float, recorded: bool) -> None:
        """Looks at the robot every ``period`` [s]; ``recorded`` as in ``Marks``."""
        super().__init__(period)
        self._meshcat = meshcat
        self._recorded = recorded
        self._report = self.DeclareAbstractInputPort(
            "atlas_sim_interface_state", AbstractValue.Make(AtlasSimInterfaceState())
        )
        self._place: tuple[float, float] | None = None

    def _publish(self, context: Context) -> None:
        if self._recorded and self._place is not None:
            return
        report: Any = self._report.Eval(context)
        pelvis = report.pos_est.position
        place = float(pelvis.x), float(pelvis.y)
        if self._place is None or math.dist(place, self._place) > LEAST_MOVE:
            self._place = place
            center_at(self._meshcat, *place)
