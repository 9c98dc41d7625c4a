"""Shapes that appear, move and disappear in Meshcat, live and in a recording.

A recording holds motions and properties but no new objects; so every object is made
once, and then shown or hidden. A recording must be started before the simulation is
built; otherwise it lacks the initial objects.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import count
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat, Rgba

from atlas_drake.clients.view.shapes import Shape

PATH = "/atlas_drake/shapes"
SPARE = 16
"""Number of hidden objects that are kept when nothing is recorded."""


class Visibility:
    """Shows and hides objects at a time, each only when it changes.

    What is visible is kept here and not in a Context, because it belongs to the
    browser, as with Drake's own visualizers.
    """

    def __init__(self, meshcat: Meshcat) -> None:
        """Starts without any object shown or hidden in ``meshcat``."""
        self._meshcat = meshcat
        self._visible: dict[str, bool] = {}

    def show(self, path: str, visible: bool, time: float) -> None:
        """Shows or hides an object from ``time`` [s] on.

        An object that is first shown or hidden after time 0 had the opposite state
        before, in a recording and while a browser loads it.
        """
        before = self._visible.get(path)
        if before == visible:
            return
        self._visible[path] = visible
        if before is None and time > 0.0:
            self._meshcat.SetProperty(path, "visible", not visible, 0.0)
            self._meshcat.SetProperty(path, "visible", not visible)
        self._meshcat.SetProperty(path, "visible", visible, time)

    def forget(self, path: str) -> None:
        """Forgets an object that is deleted."""
        del self._visible[path]


class MeshcatShapes:
    """Shows a changing set of shapes."""

    def __init__(self, meshcat: Meshcat, recorded: bool) -> None:
        """Draws in ``meshcat``.

        A recording must be able to show all shapes again; without one few hidden
        objects are kept, so that a view does not grow over hours.
        """
        self._meshcat, self._recorded = meshcat, recorded
        self._begin()

    def _begin(self) -> None:
        self._meshcat.Delete(PATH)
        self._visibility = Visibility(self._meshcat)
        self._numbers = count()
        self._time = 0.0
        # In the order in which they were last shown.
        self._paths: dict[Any, str] = {}

    def show(self, shapes: Iterable[Shape], time: float) -> None:
        """Shows exactly these shapes from ``time`` [s] on.

        When time runs backward, a new run begins.
        """
        if time < self._time:
            self._begin()
        self._time = time
        shown = {}
        for shape in shapes:
            key = shape.name, shape.solid.key
            path = self._paths.pop(key, None) or self._draw(shape)
            shown[key] = path
            if not shape.X_WS.IsExactlyIdentity():
                scale = [1.0, 1.0, shape.length]
                self._meshcat.SetTransform(path, shape.X_WS, time)
                self._meshcat.SetProperty(f"{path}/solid", "scale", scale, time)
            self._visibility.show(path, True, time)
        for path in self._paths.values():
            self._visibility.show(path, False, time)
        while not self._recorded and len(self._paths) > SPARE:
            path = self._paths.pop(next(iter(self._paths)))
            self._meshcat.Delete(path)
            self._visibility.forget(path)
        self._paths |= shown

    def _draw(self, shape: Shape) -> str:
        """Makes the object of a shape, without shadow, and returns its path."""
        meshcat, solid = self._meshcat, shape.solid
        path = f"{PATH}/{shape.name}/{next(self._numbers)}"
        vertices, faces = solid.triangles
        points = np.asfortranarray(vertices)
        color = Rgba(*solid.color, solid.opacity)
        # In a node of its own, because a transform resets the scale of its node.
        meshcat.SetTriangleMesh(f"{path}/solid", points, faces, color)
        target = f"{path}/solid/<object>"
        meshcat.SetProperty(target, "castShadow", False)
        if solid.layer:
            meshcat.SetProperty(target, "material.depthTest", False)
            meshcat.SetProperty(target, "material.transparent", True)
            meshcat.SetProperty(target, "renderOrder", float(solid.layer))
        return path
