"""Overlays of balance: CoM, DCM, CoP, support polygon, planned paths, swing path.

Drawn from the station's ports while switched on. The plan comes from the controller's
status; contact forces are in ``contact_forces``.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from pydrake.geometry import Cylinder, Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.control.balance.feedback import dcm, pendulum_frequency
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.control.wrenches import center_of_pressure
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.palette import COM, COP, DCM, SUPPORT, SWING
from atlas_drake.robot import Robot
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.marks import Marks, Timeline
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.shapes import draw_flat, thinned, tube

PATH = "/atlas_drake/balance"
BALL, PLUMB_LINE = 0.03, 0.003
"""Radii of the center of mass and of the line down to the ground [m]."""
DISC = {"com": 0.018, "dcm": 0.022, "cop": 0.014}
"""Radii of the discs on the ground [m]."""
DISC_HEIGHT = 0.004
LIFT = {"support": 0.006, "plan": 0.010, "com": 0.012, "dcm": 0.014, "cop": 0.016}
"""Heights of the discs above the ground, all different, so that none hides another
[m]."""
TUBE = 0.005
"""Radius of the paths [m]."""
LOWEST = 0.1
"""Lower bound of the center of mass' height, for a robot that lies on the ground
[m]."""
PATHS_EVERY = 4
"""Pictures between updates of the paths, which are slow to compute and change
slowly."""
AREA_GRID, CURVE_GRID, BEND = 0.002, 0.001, 0.002
"""Corners and points are rounded to a grid [m]; points are left out where a curve bends
by less [m], because a recording keeps every shape."""
_SHAPES = {
    "com_ball": Sphere(BALL),
    "com_line": Cylinder(PLUMB_LINE, 1.0),
    **{name: Cylinder(radius, DISC_HEIGHT) for name, radius in DISC.items()},
}
_COLORS = {"com": Rgba(*COM), "dcm": Rgba(*DCM), "cop": Rgba(*COP)}
_CURVES = {"plan_com": Rgba(*COM), "plan_dcm": Rgba(*DCM), "swing": Rgba(*SWING)}
_AREA = Rgba(*SUPPORT, 0.5)
_NAMES = ("com", "dcm", "cop", "support", "plan", "swing")

Point = tuple[float, float, float]


class BalancePoints(NamedTuple):
    """Points in W [m], shape (3,).

    Attributes:
        ground: Height of the lower sole [m].
        com: Center of mass.
        dcm: Divergent component of motion, on the ground.
        cop: Center of pressure; None without a load on the feet.
    """

    ground: float
    com: np.ndarray
    dcm: np.ndarray
    cop: np.ndarray | None


def balance_points(terms: WholeBodyTerms, wrenches: np.ndarray) -> BalancePoints:
    """Computes the points; for ``wrenches``, shape (12,), see ``RobotSensors``."""
    ground = min(float(foot.p_WF[2]) for foot in terms.feet)
    omega = pendulum_frequency(float(terms.com[2]) - ground)
    soles = [foot.p_WF for foot in terms.feet]
    return BalancePoints(
        ground,
        terms.com,
        np.append(dcm(terms, omega), ground),
        center_of_pressure(soles, wrenches),
    )


class BalanceMarks(Display):
    """Draws the balance overlays.

    Input ports:
        state: State of the plant.
        controller_status: ``ControllerStatus``
        planned_paths: ``PlannedPaths``
        foot_wrenches: Contact wrenches on both soles, see ``RobotSensors``.
    """

    __slots__ = ()

    def __init__(
        self,
        meshcat: Meshcat,
        robot: Robot,
        overlays: Overlays,
        period: float,
        recorded: bool,
    ) -> None:
        """Draws what is on every ``period`` [s]; ``recorded`` as in ``Marks``."""
        super().__init__(period)
        self._meshcat = meshcat
        self._overlays = overlays
        self._model = WholeBodyModel(robot)
        self._scratch = self._model.create_context()
        self._state = self.DeclareVectorInputPort("state", self._model.num_states)
        self._wrenches = self.DeclareVectorInputPort("foot_wrenches", 12)
        self._status, self._paths = self.declare_values(
            "controller_status", "planned_paths"
        )
        self._pictures = -1
        self._timeline = Timeline(meshcat)
        self._drawn: set[str] = set()
        meshcat.Delete(PATH)
        self._support = Marks(meshcat, f"{PATH}/support", self._draw_support, recorded)
        self._curves = {
            name: Marks(
                meshcat, f"{PATH}/{name}", partial(self._draw_curve, color), recorded
            )
            for name, color in _CURVES.items()
        }

    def _publish(self, context: Context) -> None:
        on = {name for name in _NAMES if self._overlays.is_on(name)}
        time = context.get_time()
        for path in self._drawn:
            if path.split("_")[0] not in on:
                self._timeline.show(f"{PATH}/{path}", False, time)
        for name, marks in [("support", self._support), *self._curves.items()]:
            if name.split("_")[0] not in on:
                marks.show([], time)
        if not on:
            return
        plan: Plan = self._status.Eval(context).plan
        terms = self._model.evaluate(self._scratch, self._state.Eval(context))
        at = balance_points(terms, self._wrenches.Eval(context))
        ground = at.ground
        if "com" in on:
            x, y, z = at.com
            height = max(z - ground, LOWEST)
            self._move("com_ball", [x, y, z], time)
            self._move("com_line", [x, y, ground + 0.5 * height], time)
            line = f"{PATH}/com_line/shape"
            self._meshcat.SetProperty(line, "scale", [1.0, 1.0, float(height)], time)
            self._move("com", [x, y, ground + LIFT["com"]], time)
        for name, point in (("dcm", at.dcm), ("cop", at.cop)):
            if name in on and point is not None:
                self._move(name, point + np.array([0.0, 0.0, LIFT[name]]), time)
            elif name in self._drawn:
                self._timeline.show(f"{PATH}/{name}", False, time)
        if "support" in on:
            self._support.show(_area(plan.support, ground), time)
        self._pictures += 1
        if self._pictures % PATHS_EVERY:
            return
        if not on & {"plan", "swing"}:
            return
        paths: PlannedPaths = self._paths.Eval(context)
        if "plan" in on:
            for name in ("com", "dcm"):
                points, flat = None, getattr(paths, name)
                if flat is not None:
                    z = np.full(len(flat), ground + LIFT["plan"])
                    points = np.column_stack([flat, z])
                self._curves[f"plan_{name}"].show(_curve(points), time)
        if "swing" in on:
            self._curves["swing"].show(_curve(paths.swing), time)

    def _move(self, name: str, p_W: Any, time: float) -> None:
        """Moves a shape to a point in W [m], shape (3,)."""
        path = f"{PATH}/{name}"
        if name not in self._drawn:
            self._drawn.add(name)
            # A node of its own, because every transform resets the scale of its node.
            color = _COLORS[name.split("_", maxsplit=1)[0]]
            self._meshcat.SetObject(f"{path}/shape", _SHAPES[name], color)
            if name != "com_line":
                self._see_through(f"{path}/shape")
        self._meshcat.SetTransform(path, RigidTransform(np.array(p_W)), time)
        self._timeline.show(path, True, time)

    def _draw_support(self, path: str, mark: object) -> None:
        corners: Any = mark
        fan = [[0, i, i + 1] for i in range(1, len(corners) - 1)]
        faces = np.array(fan, dtype=np.int32).T
        draw_flat(self._meshcat, path, np.array(corners).T, faces, _AREA)
        self._see_through(path, order=1.0)

    def _draw_curve(self, color: Rgba, path: str, mark: object) -> None:
        points: Any = mark
        draw_flat(self._meshcat, path, *tube(np.array(points), TUBE), color)

    def _see_through(self, path: str, order: float = 2.0) -> None:
        """Draws an object over all others, a higher order on top."""
        target = f"{path}/<object>"
        self._meshcat.SetProperty(target, "material.depthTest", False)
        self._meshcat.SetProperty(target, "material.transparent", True)
        self._meshcat.SetProperty(target, "renderOrder", order)


def _area(corners: np.ndarray | None, ground: float) -> list[tuple[Point, ...]]:
    """Makes the mark of the polygon, if there is one."""
    if corners is None:
        return []
    z = np.full(len(corners), ground + LIFT["support"])
    return [_points(np.column_stack([corners, z]), AREA_GRID)]


def _curve(points: np.ndarray | None) -> list[tuple[Point, ...]]:
    """Makes the mark of the curve, if there is one."""
    return [] if points is None else [_points(thinned(points, BEND), CURVE_GRID)]


def _points(points: np.ndarray, grid: float) -> tuple[Point, ...]:
    """Rounds to a grid [m], so that marks that look the same are equal."""
    return tuple(
        (round(float(x), 4), round(float(y), 4), round(float(z), 4))
        for x, y, z in grid * np.round(points / grid)
    )
