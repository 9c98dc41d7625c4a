"""The world around the robot in Meshcat: ground, grid, light and camera.

Only looks; the ground that the robot stands on is part of the plant.
"""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Box, Meshcat, Rgba
from pydrake.math import RigidTransform

GROUND_SIZE, GROUND_THICKNESS = 24.0, 0.02
"""Side and thickness of the slab that is drawn [m]."""
GRID_SPACING, GRID_BOLD = 0.25, 4
"""Between lines [m]; every so many lines are darker."""
GRID_SIZE = 8.0
"""[m]"""
GRID_LIFT = 0.001
"""Of the lines above the ground, so that they are not hidden in it [m]."""

CAMERA_POSITION = np.array([2.35, -1.75, 1.25])
CAMERA_TARGET = np.array([0.3, 0.0, 0.88])
"""In W [m]: three quarters from the front, start and end of the tutorial in view."""


def prepare_scene(meshcat: Meshcat) -> None:
    """Dresses an empty Meshcat."""
    meshcat.SetProperty("/Grid", "visible", False)
    meshcat.SetProperty("/Axes", "visible", False)
    meshcat.SetProperty("/Background", "top_color", [0.80, 0.87, 0.94])
    meshcat.SetProperty("/Background", "bottom_color", [0.97, 0.98, 0.99])
    _add_ground(meshcat)
    _add_light(meshcat)
    meshcat.SetCameraPose(CAMERA_POSITION, CAMERA_TARGET)


def _add_ground(meshcat: Meshcat) -> None:
    path = "/atlas_drake/ground"
    slab = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
    meshcat.SetObject(f"{path}/slab", slab, Rgba(0.86, 0.88, 0.90, 1.0))
    meshcat.SetTransform(
        f"{path}/slab", RigidTransform([0.0, 0.0, -0.5 * GROUND_THICKNESS])
    )
    count = round(0.5 * GRID_SIZE / GRID_SPACING)
    numbers = np.arange(-count, count + 1)
    for name, chosen, color in (
        ("fine", numbers[numbers % GRID_BOLD != 0], Rgba(0.76, 0.79, 0.82, 1.0)),
        ("bold", numbers[numbers % GRID_BOLD == 0], Rgba(0.58, 0.63, 0.68, 1.0)),
    ):
        at = GRID_SPACING * chosen
        end = np.full(at.size, 0.5 * GRID_SIZE)
        lift = np.full(at.size, GRID_LIFT)
        starts = np.hstack([[at, -end, lift], [-end, at, lift]])
        ends = np.hstack([[at, end, lift], [end, at, lift]])
        meshcat.SetLineSegments(f"{path}/{name}", starts, ends, 1.0, color)


def _add_light(meshcat: Meshcat) -> None:
    meshcat.SetProperty("/Lights/SpotLight", "visible", True)
    meshcat.SetProperty("/Lights/SpotLight/<object>", "castShadow", True)
