"""The scene of a film for Drake's own renderer, which needs neither window nor browser.

Adds ground, lamps and the shapes of a record to the SceneGraph of a replay.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common import MemoryFile
from pydrake.geometry import (
    Box,
    ClippingRange,
    ColorRenderCamera,
    GeometryId,
    GeometryInstance,
    InMemoryMesh,
    LightParameter,
    MakeRenderEngineVtk,
    Mesh,
    PerceptionProperties,
    QueryObject,
    RenderCameraCore,
    RenderEngineVtkParams,
    RenderLabel,
    Rgba,
    Role,
    SceneGraph,
)
from pydrake.geometry import Shape as DrakeShape
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context
from pydrake.systems.sensors import CameraInfo

from atlas_drake.clients.film.file import FilmError
from atlas_drake.clients.view.colors import GAMMA
from atlas_drake.clients.view.shapes import Shape
from atlas_drake.clients.view.solids import Solid, Triangles, grid, ribbons
from atlas_drake.palette import Color
from atlas_drake.robot import Robot

Picture = NDArray[np.uint8]
"""Red, green and blue of each pixel, shape (height, width, 3)."""

FIELD_OF_VIEW = 32.0
"""Vertical field of view of the camera [degree]."""
NEAR, FAR = 0.1, 150.0
"""Near and far limit of the camera's view from its lens [m]."""
SKY = np.array([0.84, 0.90, 0.95])
GROUND_LIGHT: Color = (0.86, 0.87, 0.88)
"""Color of the ground as a light intensity."""
GROUND_SEEN: Color = (0.88, 0.885, 0.89)
"""Color of the ground as it is seen, below transparent solids."""
GROUND_SIZE, GROUND_THICKNESS = 160.0, 0.02
"""Side and thickness of the ground slab [m]."""
GRID_SIZE, GRID_SPACING, GRID_LIFT = 40.0, 0.5, 0.002
"""Side, line spacing and height above the ground of the grid [m]."""
GRID_WIDTH, GRID_LIGHT = 0.012, (0.75, 0.78, 0.81)
SHADOW_MAP = 1280
"""Side of the shadow map [pixel]; without a graphics card it takes a third of the time
of a small picture."""
LAMP, LAMP_INTENSITY, LAMP_CONE = np.array([3.0, -5.0, 9.0]), 1.7, 62.0
"""The lamp with shadow: position from the camera's target [m], in upright axes that
turn with a camera that follows; brightness; half angle [degree]."""
FILL, FILL_INTENSITY = np.array([45.0, 3.0, 45.0]), 2.0
"""The lamp without shadow: position from the target [m]; brightness."""
BACK, BACK_INTENSITY = np.array([-45.0, -3.0, 28.0]), 0.6
"""The lamp behind it, weaker: without it what faces away from the others is black."""
DARKEST, BRIGHTEST = 0.35, 1.25
"""Brightness of a colored link where the picture is black, and where it is white."""
NEARER = 0.1
"""Factor by which shapes that nothing hides are nearer to the lens, and smaller."""
RENDERER = "vtk"


class FilmStage:
    """Takes pictures of a replayed robot."""

    def __init__(
        self,
        scene_graph: SceneGraph,
        robot: Robot,
        size: tuple[int, int],
        X_TC: RigidTransform,
    ) -> None:
        """Sets up the scene, before the diagram of the SceneGraph is built.

        ``X_TC`` is the pose of the camera from its target, ``size`` in pixels.
        """
        self._scene_graph = scene_graph
        self._source = scene_graph.RegisterSource("film")
        self._camera = ColorRenderCamera(
            RenderCameraCore(
                RENDERER,
                CameraInfo(*size, np.radians(FIELD_OF_VIEW)),
                ClippingRange(NEAR, FAR),
                RigidTransform(),
            )
        )
        self._labels = _labels(scene_graph, robot)
        self._add_ground()
        try:
            scene_graph.AddRenderer(RENDERER, MakeRenderEngineVtk(_looks(X_TC)))
        except RuntimeError as error:
            raise FilmError(f"Drake cannot draw robot and world: {error}") from error
        self._shown: dict[Any, GeometryId] = {}

    def picture(
        self,
        context: Context,
        query: QueryObject,
        shapes: Sequence[Shape],
        colors: Sequence[Color] | None,
        X_WC: RigidTransform,
    ) -> Picture:
        """Takes one picture from ``X_WC``; without colors the links have their own."""
        self._show(context, shapes, X_WC.translation())
        world = SceneGraph.world_frame_id()
        image = query.RenderColorImage(self._camera, world, X_WC)
        picture: Picture = np.array(image.data[:, :, :3])
        if colors is not None:
            seen = query.RenderLabelImage(self._camera, world, X_WC)
            self._color(picture, colors, seen.data[:, :, 0])
        return picture

    def _color(
        self, picture: Picture, colors: Sequence[Color], seen: NDArray[np.int16]
    ) -> None:
        """Colors the links in their own light and shade."""
        numbers = np.full(np.iinfo(np.int16).max + 1, -1)
        for number, labels in enumerate(self._labels):
            numbers[labels] = number
        joint = numbers[seen]
        links = joint >= 0
        grey = picture[links].mean(axis=1, keepdims=True) / 255.0
        light = 255.0 * (DARKEST + (BRIGHTEST - DARKEST) * grey)
        picture[links] = np.minimum(light * np.array(colors)[joint[links]], 255.0)

    def _show(
        self, context: Context, shapes: Iterable[Shape], p_WC: NDArray[np.float64]
    ) -> None:
        """Shows exactly these shapes; those that look the same stay."""
        asked = {}
        for shape in shapes:
            X_WS, scale = _placed(shape, p_WC)
            key = shape.name, shape.solid.key, scale, X_WS.GetAsMatrix34().tobytes()
            asked[key] = shape.solid, X_WS, scale
        for key in self._shown.keys() - asked.keys():
            geometry = self._shown.pop(key)
            self._scene_graph.RemoveGeometry(context, self._source, geometry)
        for key in asked.keys() - self._shown.keys():
            solid, X_WS, scale = asked[key]
            instance = _instance(_mesh(solid.triangles, scale), X_WS, _light(solid))
            self._shown[key] = self._scene_graph.RegisterGeometry(
                context, self._source, SceneGraph.world_frame_id(), instance
            )

    def _add_ground(self) -> None:
        slab = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
        X_WS = RigidTransform([0.0, 0.0, -0.5 * GROUND_THICKNESS])
        at = np.arange(-0.5 * GRID_SIZE, 0.5 * GRID_SIZE + 1e-9, GRID_SPACING)
        lines = _mesh(ribbons(*grid(at, 0.5 * GRID_SIZE, 0.0), GRID_WIDTH))
        X_WG = RigidTransform([0.0, 0.0, GRID_LIFT])
        for instance in (
            _instance(slab, X_WS, GROUND_LIGHT),
            _instance(lines, X_WG, GRID_LIGHT),
        ):
            self._scene_graph.RegisterAnchoredGeometry(self._source, instance)


def _placed(
    shape: Shape, p_WC: NDArray[np.float64]
) -> tuple[RigidTransform, tuple[float, float, float]]:
    """Returns pose and scale of a shape in the scene.

    A shape that nothing may hide looks the same just before the lens.
    """
    if shape.solid.layer < 2:
        return shape.X_WS, (1.0, 1.0, shape.length)
    p_WS = p_WC + NEARER * (shape.X_WS.translation() - p_WC)
    scale = NEARER, NEARER, NEARER * shape.length
    return RigidTransform(shape.X_WS.rotation(), p_WS), scale


def _labels(scene_graph: SceneGraph, robot: Robot) -> list[list[int]]:
    """Returns, for each joint, what a label image has for the links that it moves."""
    inspector = scene_graph.model_inspector()
    frames = {inspector.GetName(f): f for f in inspector.GetAllFrameIds()}
    return [
        [
            int(inspector.GetPerceptionProperties(one).GetProperty("label", "id"))
            for link in links
            for one in inspector.GetGeometries(
                frames[f"{robot.name}::{link}"], Role.kPerception
            )
        ]
        for links in robot.moved_links
    ]


def _instance(
    shape: DrakeShape, X_WS: RigidTransform, color: Color
) -> GeometryInstance:
    """Makes a geometry of a color."""
    properties = PerceptionProperties()
    properties.AddProperty("phong", "diffuse", Rgba(*color))
    properties.AddProperty("label", "id", RenderLabel.kDontCare)
    instance = GeometryInstance(X_WS, shape, f"film_{GeometryId.get_new_id()}")
    instance.set_perception_properties(properties)
    return instance


def _mesh(
    triangles: Triangles, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> Mesh:
    """Writes triangles, lit from above, in the renderer's format."""
    vertices, faces = triangles
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices.T]
    lines.append("vn 0 0 1")
    lines += [f"f {i}//1 {j}//1 {k}//1" for i, j, k in faces.T + 1]
    file = MemoryFile("\n".join(lines) + "\n", ".obj", "triangles")
    return Mesh(InMemoryMesh(mesh_file=file), scale3=scale)


def _light(solid: Solid) -> Color:
    """Returns the light intensity of a solid over the ground.

    Transparency is not drawn reliably.
    """
    r, g, b = (
        (solid.opacity * own + (1.0 - solid.opacity) * below) ** GAMMA
        for own, below in zip(solid.color, GROUND_SEEN, strict=True)
    )
    return r, g, b


def _looks(X_TC: RigidTransform) -> RenderEngineVtkParams:
    """Lamps hang in the camera's frame, so that they follow the robot with it."""
    X_CT = X_TC.inverse()
    p_CT = X_CT.translation()

    def lamp(p_TL: Any, intensity: float, cone: float) -> LightParameter:
        position = X_CT @ p_TL
        return LightParameter(
            type="spot" if cone else "point",
            frame="camera",
            position=position,
            direction=p_CT - position,
            intensity=intensity,
            cone_angle=cone,
        )

    return RenderEngineVtkParams(
        default_clear_color=SKY,
        lights=[
            lamp(LAMP, LAMP_INTENSITY, LAMP_CONE),
            lamp(FILL, FILL_INTENSITY, 0.0),
            lamp(BACK, BACK_INTENSITY, 0.0),
        ],
        cast_shadows=True,
        shadow_map_size=SHADOW_MAP,
    )
