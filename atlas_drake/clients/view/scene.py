"""The scene around the robot in Meshcat, and how it follows the robot.

Ground, grid, light and camera: appearance only; the plant has the ground for contact.
"""

from __future__ import annotations

import math

import numpy as np
from pydrake.geometry import Box, Meshcat, Rgba
from pydrake.math import RigidTransform

from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.solids import grid
from atlas_drake.records import TickRecord
from atlas_drake.scenario import Scenario
from atlas_drake.worlds.terrain import surface_height
from atlas_drake.worlds.world_file import View

GROUND_SIZE, GROUND_THICKNESS = 80.0, 0.02
"""Side and thickness of the ground slab in the view [m]."""
GRID_SPACING, GRID_BOLD = 0.25, 4
"""Distance between lines [m], and the interval of darker lines."""
GRID_LINES = 24
"""Number of lines on each side of the middle of the grid, which goes with the robot."""
GRID_LIFT = 0.001
"""Height of the lines above the ground, so that the ground does not hide them [m]."""

CAMERA = "/Cameras/default/rotated/<object>"
"""Path of Meshcat's camera; objects below this path move with the view."""
FIELD_OF_VIEW = 38.0
"""Vertical field of view of the camera [degree]: narrower than Meshcat's default, which
distorts."""
USUAL = View()
"""Initial camera, from the robot's first place on the ground, in axes W [m]: from the
front and side, with start and end of the tutorial in view."""

SUN = "/Lights/SpotLight/<object>"
SUN_POSITION = np.array([2.0, -3.0, 6.0])
"""Position of the lamp that throws the shadows, from the robot's place, in W [m]."""
GROUND = "/atlas_drake/ground"


def prepare_scene(meshcat: Meshcat) -> None:
    """Sets up ground, light and camera of an empty Meshcat."""
    meshcat.SetProperty("/Grid", "visible", False)
    meshcat.SetProperty("/Axes", "visible", False)
    meshcat.SetProperty("/Background/<object>", "top_color", [0.80, 0.87, 0.94])
    meshcat.SetProperty("/Background/<object>", "bottom_color", [0.97, 0.98, 0.99])
    _add_ground(meshcat)
    _add_light(meshcat)
    meshcat.SetProperty(CAMERA, "fov", FIELD_OF_VIEW)
    look_at(meshcat, np.zeros(3))


def look_at(meshcat: Meshcat, p_WG: np.ndarray) -> None:
    """Puts the camera beside a robot that stands at ``p_WG`` [m], shape (3,)."""
    meshcat.SetCameraPose(USUAL.lens + p_WG, USUAL.target + p_WG)


def center_at(meshcat: Meshcat, x: float, y: float) -> None:
    """Moves ground, grid and lamp to a robot at x, y in W [m]."""
    # By whole squares of the darker lines, which then seem to stand still.
    square = GRID_SPACING * GRID_BOLD
    p_WS = [square * round(x / square), square * round(y / square), 0.0]
    meshcat.SetTransform(GROUND, RigidTransform(p_WS))
    p_WL = SUN_POSITION + np.array([x, y, 0.0])
    meshcat.SetProperty(SUN, "position", p_WL.tolist())
    # The lamp's target is no object of the scene: only its matrix can be set, in the
    # browser's own axes, whose y points up and whose z is -y of W.
    meshcat.SetProperty(SUN, "target.matrixWorld.elements[12]", x)
    meshcat.SetProperty(SUN, "target.matrixWorld.elements[14]", -y)


def show_start(meshcat: Meshcat, scenario: Scenario) -> None:
    """Shows the world as its file says, or else the robot where it begins."""
    view = scenario.surroundings().view
    if view is not None:
        meshcat.SetCameraPose(np.array(view.lens), np.array(view.target))
        return
    x, y = scenario.start_pose()[0]
    look_at(meshcat, np.array([x, y, surface_height(scenario.all_terrain(), x, y)]))


def _add_ground(meshcat: Meshcat) -> None:
    slab = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
    meshcat.SetObject(f"{GROUND}/slab", slab, Rgba(0.93, 0.94, 0.95, 1.0))
    X_GS = RigidTransform([0.0, 0.0, -0.5 * GROUND_THICKNESS])
    meshcat.SetTransform(f"{GROUND}/slab", X_GS)
    numbers = np.arange(-GRID_LINES, GRID_LINES + 1)
    bold = numbers % GRID_BOLD == 0
    for name, chosen, color in (
        ("fine", numbers[~bold], Rgba(0.76, 0.79, 0.82, 1.0)),
        ("bold", numbers[bold], Rgba(0.58, 0.63, 0.68, 1.0)),
    ):
        reach = GRID_SPACING * GRID_LINES
        starts, ends = grid(GRID_SPACING * chosen, reach, GRID_LIFT)
        meshcat.SetLineSegments(f"{GROUND}/{name}", starts, ends, 1.0, color)


def _add_light(meshcat: Meshcat) -> None:
    """Sets one lamp above with soft shadows; other lamps do not fade with distance."""
    for name, intensity in {
        "PointLightNegativeX": 0.35,
        "PointLightPositiveX": 0.35,
        "FillLight": 0.3,
        "AmbientLight": 0.75,
    }.items():
        light = f"/Lights/{name}/<object>"
        meshcat.SetProperty(light, "intensity", intensity)
        if name.startswith("Point"):
            meshcat.SetProperty(light, "decay", 0.0)
            meshcat.SetProperty(light, "distance", 0.0)
    meshcat.SetProperty(SUN.removesuffix("/<object>"), "visible", True)
    center_at(meshcat, 0.0, 0.0)
    for name, value in {
        "intensity": 2.2,
        "decay": 0.0,
        "angle": 1.25,
        "penumbra": 1.0,
        "castShadow": True,
        "shadow.radius": 4.0,
        "shadow.bias": -0.0005,
        "shadow.mapSize.width": 2048.0,
        "shadow.mapSize.height": 2048.0,
    }.items():
        meshcat.SetProperty(SUN, name, value)


LAG = 0.7
"""Time constant of the camera, so that it does not sway with the steps [s]."""
MIN_MOVE = 0.05
"""Distance of the pelvis over the ground after which the scene moves [m]."""


class Following:
    """Moves the scene with the pelvis over the ground, and the camera if asked to.

    While the camera follows, the mouse cannot turn the view. In a recording, which
    cannot hold the motion of the light, the scene stays where the robot begins.
    """

    def __init__(self, meshcat: Meshcat, overlays: Overlays) -> None:
        """Follows in ``meshcat``."""
        self._meshcat = meshcat
        self._overlays = overlays
        self._scene: tuple[float, float] | None = None
        self._target: np.ndarray | None = None

    def show(self, record: TickRecord) -> None:
        """Looks at the robot, once per picture."""
        x, y, _ = map(float, record.pelvis.position)
        stays = self._scene is not None and (
            self._overlays.recorded or math.dist((x, y), self._scene) < MIN_MOVE
        )
        if not stays:
            self._scene = x, y
            center_at(self._meshcat, x, y)
        if "follow" in self._overlays.on:
            ground = min(float(p_WF[2]) for p_WF in record.feet.positions)
            goal = np.array([x, y, ground])
            target = goal if self._target is None else self._target
            share = 1.0 - math.exp(-1.0 / (FRAME_RATE * LAG))
            self._target = target + share * (goal - target)
            look_at(self._meshcat, self._target)
