"""What views show of a record beside the robot: shapes in W.

The same for Meshcat and for films. Colors of links are in ``colors``.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from typing import NamedTuple

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.clients.view.footsteps import footstep_marks, mark_solid
from atlas_drake.clients.view.solids import Points, Solid, polygon, tube, turned
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.palette import COM, COP, DCM, FORCE, SUPPORT, SWING, Color
from atlas_drake.records import TickRecord
from atlas_drake.robot import SoleSize


class Shape(NamedTuple):
    """A solid, its pose in W, and a factor along its z axis.

    Several shapes may have the name of what is shown; of a shape that moves the solid
    is always the same.
    """

    name: str
    solid: Solid
    X_WS: RigidTransform = RigidTransform()
    length: float = 1.0


MOVING = {
    "com_line": [(0.003, 0.0), (0.003, 1.0)],
    "com_ball": [
        (0.03 * np.sin(a), -0.03 * np.cos(a)) for a in np.linspace(0.0, np.pi, 11)
    ],
    "com": [(0.0, -0.002), (0.018, -0.002), (0.018, 0.002), (0.0, 0.002)],
    "dcm": [(0.0, -0.002), (0.022, -0.002), (0.022, 0.002), (0.0, 0.002)],
    "cop": [(0.0, -0.002), (0.014, -0.002), (0.014, 0.002), (0.0, 0.002)],
    "forces": [(0.006, 0.0), (0.006, 0.85), (0.018, 0.85), (0.0, 1.0)],
}
"""Radii and heights of the solids that move [m]; line and arrow are one metre long."""
TUBE = 0.005
"""Radius of paths [m]."""
LIFT = {"support": 0.006, "plan": 0.010, "com": 0.012, "dcm": 0.014, "cop": 0.016}
"""Heights above the ground, all different, so that none hides another [m]."""
FORCE_SCALE = 0.0012
"""Length of an arrow per force [m/N]: the robot's weight on one corner is a metre."""
MIN_HEIGHT = 0.1
"""Lower bound of the center of mass' height, for a robot that lies on the ground
[m]."""
SUPPORT_OPACITY = 0.5
AREA_GRID, CURVE_GRID, CURVE_POINTS = 0.002, 0.001, 40
"""Grids to which the points of areas and curves are rounded [m], and the number of a
curve's points: a recording keeps every shape that looks different."""


def shapes_of(record: TickRecord, on: Collection[str], sole: SoleSize) -> list[Shape]:
    """Makes what views show of a record, from the ground up: footsteps and overlays."""
    marks = dict.fromkeys(footstep_marks(record))
    footsteps = [Shape("footsteps", mark_solid(mark, sole)) for mark in marks]
    return footsteps + overlay_shapes(record, on)


def overlay_shapes(record: TickRecord, on: Collection[str]) -> list[Shape]:
    """Makes the shapes of overlays, from the ground up."""
    ground = min(float(p_WF[2]) for p_WF in record.feet.positions)
    balance, paths = record.balance, record.paths or PlannedPaths()
    x, y, z = map(float, balance.com)
    shapes: list[Shape] = []
    if "support" in on and balance.support is not None:
        corners = _rounded(_at(balance.support, ground + LIFT["support"]), AREA_GRID)
        solid = Solid(polygon(corners.T), SUPPORT, SUPPORT_OPACITY, layer=1)
        shapes.append(Shape("support", solid))
    if "plan" in on:
        for name, path, color in (("com", paths.com, COM), ("dcm", paths.dcm, DCM)):
            if path is not None and len(path) > 1:
                points = _at(path, ground + LIFT["plan"])
                shapes.append(Shape(f"plan_{name}", _curve(points, color)))
    if "swing" in on and paths.swing is not None and len(paths.swing) > 1:
        shapes.append(Shape("swing", _curve(paths.swing, SWING)))
    if "com" in on:
        below, height = [x, y, ground], max(z - ground, MIN_HEIGHT)
        line, ball = _moving("com_line", COM), _moving("com_ball", COM)
        shapes.append(Shape("com_line", line, RigidTransform(below), height))
        shapes.append(Shape("com_ball", ball, RigidTransform([x, y, z])))
    for name, place, color in (
        ("com", balance.com[:2], COM),
        ("dcm", balance.dcm, DCM),
        ("cop", balance.cop, COP),
    ):
        if name in on and place is not None:
            X_WS = RigidTransform([*place, ground + LIFT[name]])
            shapes.append(Shape(name, _moving(name, color), X_WS))
    if "forces" in on:
        for number, contact in enumerate(record.contacts or ()):
            length = float(np.linalg.norm(contact.force_W))
            if length > 0.0:
                R_WS = RotationMatrix.MakeFromOneVector(contact.force_W, 2)
                X_WS = RigidTransform(R_WS, contact.p_WC)
                arrow, size = _moving("forces", FORCE), FORCE_SCALE * length
                shapes.append(Shape(f"forces/{number}", arrow, X_WS, size))
    return shapes


@cache
def _moving(name: str, color: Color) -> Solid:
    """Makes a solid that moves but keeps its form, once."""
    layer = 0 if name in ("com_line", "forces") else 2
    return Solid(turned(MOVING[name]), color, layer=layer)


def _curve(points: Points, color: Color) -> Solid:
    kept = np.linspace(0, len(points) - 1, min(len(points), CURVE_POINTS)).round()
    curve = _rounded(points[kept.astype(int)], CURVE_GRID)
    return Solid(tube(curve, TUBE), color)


def _rounded(points: Points, grid: float) -> Points:
    return grid * np.round(points / grid) + 0.0  # No -0.0, which would differ.


def _at(flat: Points, height: float) -> Points:
    """Adds a height [m] to points in the plane, shape (k, 2)."""
    return np.column_stack([flat, np.full(len(flat), height)])
