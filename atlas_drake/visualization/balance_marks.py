"""Balance on the picture: CoM, DCM, CoP, support polygon, planned paths, swing path.

Drawn from the station's ports while it is switched on. What is planned comes from
``planned_paths``; contact forces are in ``contact_forces``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Cylinder, Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, LeafSystem

from atlas_drake.control.centre_of_pressure import centre_of_pressure
from atlas_drake.control.tasks import dcm, pendulum_frequency
from atlas_drake.control.whole_body_model import WholeBodyModel, WholeBodyTerms
from atlas_drake.robot import Robot
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.palette import COM, COP, DCM, SUPPORT, SWING
from atlas_drake.visualization.planned_paths import (
    planned_paths,
    support_of,
    swing_path,
)
from atlas_drake.visualization.ribbons import draw_flat
from atlas_drake.visualization.tubes import tube

PATH = "/atlas_drake/balance"
BALL, PLUMB_LINE = 0.03, 0.003
"""Radii of the centre of mass and of the line down to the ground [m]."""
DISC = {"com": 0.018, "dcm": 0.022, "cop": 0.014}
"""Radii of the discs on the ground [m]."""
DISC_HEIGHT = 0.004
LIFT = {"support": 0.006, "plan": 0.010, "com": 0.012, "dcm": 0.014, "cop": 0.016}
"""Above the ground, one over the other, so that none hides in another [m]."""
TUBE = 0.005
"""Radius of the paths [m]."""
LOWEST = 0.1
"""The centre of mass of a robot on the ground counts as this high at least [m]."""
PATHS_EVERY = 4
"""Pictures between looks at the paths, which are dear to compute and slow to change."""
_COLORS = {"com": COM, "dcm": DCM, "cop": COP}
_NAMES = ("com", "dcm", "cop", "support", "plan", "swing")


class BalanceMarks(LeafSystem):
    """Draws what balance is about.

    Input ports:
        state: Of the plant.
        controller_state: ``ControllerState``
        foot_wrenches: Of contact on both soles, see ``RobotSensors``.
    """

    def __init__(
        self, meshcat: Meshcat, robot: Robot, overlays: Overlays, period: float
    ) -> None:
        """Looks every ``period`` [s] at what is switched on."""
        super().__init__()
        self._meshcat = meshcat
        self._overlays = overlays
        self._model = WholeBodyModel(robot)
        self._scratch = self._model.create_context()
        self._state = self.DeclareVectorInputPort("state", self._model.num_states)
        self._wrenches = self.DeclareVectorInputPort("foot_wrenches", 12)
        self._controller = self.DeclareAbstractInputPort(
            "controller_state", AbstractValue.Make(None)
        )
        self._pictures = -1
        self._drawn: dict[str, object] = {}
        self._visible: dict[str, bool] = {}
        meshcat.Delete(PATH)
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)

    def _publish(self, context: Context) -> None:
        on = {name for name in _NAMES if self._overlays.is_on(name)}
        for path, visible in self._visible.items():
            if visible and path.split("_")[0] not in on:
                self._show(path, False)
        if not on:
            return
        time = context.get_time()
        memory = self._remembered(context)
        terms = self._model.evaluate(self._scratch, self._state.Eval(context))
        ground = min(float(foot.p_WF[2]) for foot in terms.feet)
        omega = pendulum_frequency(max(float(terms.com[2]) - ground, LOWEST))
        if "com" in on:
            self._draw_com(terms, ground, time)
        if "dcm" in on:
            self._draw_disc("dcm", dcm(terms, omega), ground, time)
        if "cop" in on:
            soles = [foot.p_WF for foot in terms.feet]
            p_WC = centre_of_pressure(soles, self._wrenches.Eval(context))
            if p_WC is None:
                self._show("cop", False)
            else:
                self._draw_disc("cop", p_WC[:2], float(p_WC[2]), time)
        if "support" in on:
            support = support_of(memory)
            self._draw_support(support.vertices if support else None, ground)
        self._pictures += 1
        if self._pictures % PATHS_EVERY:
            return
        if "plan" in on:
            paths = planned_paths(memory, terms.com[:2], omega)
            for name, color in (("com", COM), ("dcm", DCM)):
                points = getattr(paths, name) if paths else None
                if points is not None:
                    z = np.full(len(points), ground + LIFT["plan"])
                    points = np.column_stack([points, z])
                self._draw_path(f"plan_{name}", points, color)
        if "swing" in on:
            self._draw_path("swing", swing_path(memory), SWING)

    def _remembered(self, context: Context) -> Any:
        controller: Any = self._controller.Eval(context)
        return controller.supervisor.memory

    def _draw_com(self, terms: WholeBodyTerms, ground: float, time: float) -> None:
        """A ball, seen through the body that hides it, and where it is above."""
        x, y, z = map(float, terms.com)
        if "com_ball" not in self._drawn:
            self._drawn["com_ball"] = True
            path = f"{PATH}/com_ball"
            self._meshcat.SetObject(path, Sphere(BALL), COM)
            self._see_through(path)
        self._move("com_ball", [x, y, z], time)
        height = max(z - ground, LOWEST)
        if "com_line" not in self._drawn:
            self._drawn["com_line"] = True
            line = Cylinder(PLUMB_LINE, 1.0)
            self._meshcat.SetObject(f"{PATH}/com_line/rod", line, COM)
        X = np.diag([1.0, 1.0, height, 1.0])
        scaled: Any = np.asfortranarray(X)
        self._meshcat.SetTransform(f"{PATH}/com_line/rod", scaled)
        self._move("com_line", [x, y, ground + 0.5 * height], time)
        self._draw_disc("com", terms.com[:2], ground, time)

    def _draw_disc(
        self, name: str, point: np.ndarray, ground: float, time: float
    ) -> None:
        if name not in self._drawn:
            self._drawn[name] = True
            disc = Cylinder(DISC[name], DISC_HEIGHT)
            self._meshcat.SetObject(f"{PATH}/{name}", disc, _COLORS[name])
            self._see_through(f"{PATH}/{name}")
        x, y = map(float, point)
        self._move(name, [x, y, ground + LIFT[name]], time)

    def _draw_support(self, corners: np.ndarray | None, ground: float) -> None:
        if corners is None:
            self._show("support", False)
            return
        if self._is_new("support", corners):
            vertices = np.vstack([corners.T, np.full(len(corners), 0.0)])
            fan = [[0, i, i + 1] for i in range(1, len(corners) - 1)]
            faces = np.array(fan, dtype=np.int32).T
            draw_flat(self._meshcat, f"{PATH}/support", vertices, faces, SUPPORT)
            self._see_through(f"{PATH}/support", order=1.0)
        p_W: Any = np.array([0.0, 0.0, ground + LIFT["support"]])
        self._meshcat.SetTransform(f"{PATH}/support", RigidTransform(p_W))
        self._show("support", True)

    def _draw_path(self, name: str, points: np.ndarray | None, color: Rgba) -> None:
        if points is None:
            self._show(name, False)
            return
        if self._is_new(name, points):
            draw_flat(self._meshcat, f"{PATH}/{name}", *tube(points, TUBE), color)
        self._show(name, True)

    def _is_new(self, name: str, points: np.ndarray) -> bool:
        """Whether something else than these points was drawn last."""
        before = self._drawn.get(name)
        if isinstance(before, np.ndarray) and np.array_equal(before, points):
            return False
        self._drawn[name] = points
        return True

    def _move(self, name: str, position: list[float], time: float) -> None:
        p_W: Any = np.array(position)
        self._meshcat.SetTransform(f"{PATH}/{name}", RigidTransform(p_W), time)
        self._show(name, True)

    def _see_through(self, path: str, order: float = 2.0) -> None:
        """Draws an object over whatever hides it, those of a higher order on top."""
        target = f"{path}/<object>"
        self._meshcat.SetProperty(target, "material.depthTest", False)
        self._meshcat.SetProperty(target, "material.transparent", True)
        self._meshcat.SetProperty(target, "renderOrder", order)

    def _show(self, name: str, visible: bool) -> None:
        if self._visible.get(name, False) != visible or name not in self._visible:
            self._visible[name] = visible
            self._meshcat.SetProperty(f"{PATH}/{name}", "visible", visible)
