"""Draws the shapes of overlays in Meshcat."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Cylinder, Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.visualization.marks import Marks, Timeline
from atlas_drake.visualization.overlay_shapes import (
    SEEN_THROUGH,
    Shape,
    ShapeKind,
)
from atlas_drake.visualization.shapes import draw_flat, thinned, tube

PATH = "/atlas_drake/overlays"
DISC_HEIGHT = 0.004
AREA_GRID, CURVE_GRID, BEND = 0.002, 0.001, 0.002
"""Corners and points are rounded to a grid [m]; points are left out where a curve bends
by less [m], because a recording keeps every shape."""
HEAD_WIDTH, HEAD_LENGTH = 3.0, 0.15
"""Radius of an arrow's head over that of its shaft; the head's share of the length."""


class OverlayMarks:
    """Draws shapes: those that change are drawn anew, the others are moved."""

    def __init__(self, meshcat: Meshcat, recorded: bool) -> None:
        """Draws in ``meshcat``; ``recorded`` as in ``Marks``."""
        self._meshcat = meshcat
        self._recorded = recorded
        self._timeline = Timeline(meshcat)
        self._changing: dict[str, Marks] = {}
        self._moving: set[str] = set()
        meshcat.Delete(PATH)

    def show(self, overlay_shapes: Iterable[Shape], time: float) -> None:
        """Shows exactly these shapes from ``time`` [s] on."""
        shapes = {shape.name: shape for shape in overlay_shapes}
        for name, shape in shapes.items():
            if shape.kind not in (ShapeKind.AREA, ShapeKind.CURVE):
                self._move(shape, time)
            elif name not in self._changing:
                self._changing[name] = Marks(
                    self._meshcat, f"{PATH}/{name}", self._draw, self._recorded
                )
        for name, marks in self._changing.items():
            marks.show([_mark(shapes[name])] if name in shapes else [], time)
        for name in self._moving - shapes.keys():
            self._timeline.show(f"{PATH}/{name}", False, time)

    def _draw(self, path: str, mark: object) -> None:
        """Draws a shape that changes."""
        assert isinstance(mark, Shape)
        points = np.array(mark.points)
        if mark.kind is ShapeKind.CURVE:
            draw_flat(
                self._meshcat, path, *tube(points, mark.radius), Rgba(*mark.color)
            )
            return
        fan = [[0, i, i + 1] for i in range(1, len(points) - 1)]
        faces = np.array(fan, dtype=np.int32).T
        color = Rgba(*mark.color, SEEN_THROUGH)
        draw_flat(self._meshcat, path, points.T, faces, color)
        self._see_through(path, order=1.0)

    def _move(self, shape: Shape, time: float) -> None:
        """Moves a shape that keeps its form, but for the length of rods and arrows."""
        path = f"{PATH}/{shape.name}"
        # A node of its own, because every transform resets the scale of its node.
        node = f"{path}/shape"
        if shape.name not in self._moving:
            self._moving.add(shape.name)
            self._make(node, shape)
        if len(shape.points) == 1:
            X_WS = RigidTransform(shape.points[0])
        else:
            X_WS, length = pose_and_length(*shape.points)
            self._meshcat.SetProperty(node, "scale", [1.0, 1.0, length], time)
        self._meshcat.SetTransform(path, X_WS, time)
        self._timeline.show(path, True, time)

    def _make(self, path: str, shape: Shape) -> None:
        """Makes the object of a shape; rods and arrows reach from z = 0 to z = 1."""
        color, radius = Rgba(*shape.color), shape.radius
        if shape.kind is ShapeKind.ROD:
            draw_flat(self._meshcat, path, *_shaft(radius, 1.0), color)
        elif shape.kind is ShapeKind.ARROW:
            draw_flat(self._meshcat, path, *_arrow(radius), color)
        else:
            is_ball = shape.kind is ShapeKind.BALL
            solid = Sphere(radius) if is_ball else Cylinder(radius, DISC_HEIGHT)
            self._meshcat.SetObject(path, solid, color)
            self._see_through(path, order=2.0)

    def _see_through(self, path: str, order: float) -> None:
        """Draws an object over all others, a higher order on top."""
        target = f"{path}/<object>"
        self._meshcat.SetProperty(target, "material.depthTest", False)
        self._meshcat.SetProperty(target, "material.transparent", True)
        self._meshcat.SetProperty(target, "renderOrder", order)


def pose_and_length(
    tail: NDArray[np.float64], tip: NDArray[np.float64]
) -> tuple[RigidTransform, float]:
    """Computes the pose in W of a rod along z that starts at its tail, and its length.

    Args:
        tail: Point in W [m], shape (3,).
        tip: Another point in W [m], shape (3,).
    """
    R_WS = RotationMatrix.MakeFromOneVector(tip - tail, 2)
    return RigidTransform(R_WS, tail), float(np.linalg.norm(tip - tail))


def _shaft(radius: float, length: float) -> tuple[Any, NDArray[np.int32]]:
    return tube(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, length]]), radius)


def _arrow(radius: float) -> tuple[Any, NDArray[np.int32]]:
    """Makes the triangles of an arrow; its head is a pyramid."""
    neck = 1.0 - HEAD_LENGTH
    vertices, faces = _shaft(radius, neck)
    rim = HEAD_WIDTH * radius * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    head = np.zeros((3, 5))
    head[:2, :4], head[2] = rim.T, [neck] * 4 + [1.0]
    sides = np.array([[0, 1, 2, 3], [1, 2, 3, 0], [4, 4, 4, 4]])
    bottom = np.array([[0, 0], [2, 3], [1, 2]])
    own = np.hstack([sides, bottom]) + vertices.shape[1]
    return np.hstack([vertices, head]), np.hstack([faces, own]).astype(np.int32)


def _mark(shape: Shape) -> Shape:
    """Rounds the points to a grid, so that shapes that look the same are equal."""
    points, grid = shape.points, AREA_GRID
    if shape.kind is ShapeKind.CURVE:
        points, grid = thinned(points, BEND), CURVE_GRID
    rounded = (grid * np.round(points / grid)).round(4).tolist()
    hashable: Any = tuple(map(tuple, rounded))
    return shape._replace(points=hashable)
