"""The video's scene for Drake's own renderer, which needs neither window nor browser.

A copy of robot, terrain and world that is posed and rendered. The copy is separate from
the simulation, so that filming changes nothing. ``video_display`` uses the pictures.
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
    RenderCameraCore,
    RenderEngineVtkParams,
    RenderLabel,
    Rgba,
    SceneGraph,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.sensors import CameraInfo

from atlas_drake.palette import FEET
from atlas_drake.robot import Robot
from atlas_drake.scenario.terrain import Block
from atlas_drake.scenario.world import WorldMaker, add_world
from atlas_drake.visualization.footsteps import (
    LANDED_OPACITY,
    FootstepMark,
    Kind,
    mark_triangles,
    sole_outline,
)
from atlas_drake.visualization.shapes import ribbons
from atlas_drake.visualization.video_camera import camera_pose
from atlas_drake.visualization.video_file import VideoError

Picture = NDArray[np.uint8]
"""Red, green and blue of each pixel, shape (height, width, 3)."""

FIELD_OF_VIEW = 32.0
"""Vertical field of view of the camera [degree]."""
NEAR, FAR = 0.1, 100.0
"""Near and far limit of the camera's view from its lens [m]."""
SKY = np.array([0.84, 0.90, 0.95])
GROUND_COLOR = np.array([0.86, 0.87, 0.88, 1.0])
GROUND_SIZE, GROUND_THICKNESS = 160.0, 0.02
"""Side and thickness of the ground slab [m]."""
GRID_SIZE, GRID_SPACING, GRID_LIFT = 40.0, 0.5, 0.002
"""Side, line spacing and height above the ground of the grid [m]."""
GRID_WIDTH, GRID_COLOR = 0.012, np.array([0.75, 0.78, 0.81, 1.0])
SHADOW_MAP = 1280
"""Side of the shadow map [pixel]; without a graphics card it takes a third of the time
of a small picture."""
LAMP, LAMP_INTENSITY, LAMP_CONE = np.array([3.0, -5.0, 9.0]), 1.7, 62.0
"""The lamp with shadow: position from the target, in axes H [m]; brightness; half angle
[degree]."""
FILL, FILL_INTENSITY = np.array([45.0, 3.0, 45.0]), 2.0
"""The lamp without shadow: position from the target, in axes H [m]; brightness."""
_RENDERER = "vtk"


class VideoStage:
    """Takes pictures of the robot in any pose."""

    def __init__(
        self,
        robot: Robot,
        terrain: Sequence[Block],
        width: int,
        height: int,
        world: Sequence[WorldMaker] = (),
        X_TC: RigidTransform | None = None,
    ) -> None:
        """Sets up the scene.

        Args:
            robot: Robot in the picture.
            terrain: Boxes on the ground.
            width: Width of the pictures [pixel].
            height: Height of the pictures [pixel].
            world: Callables that add models beside the robot.
            X_TC: Pose of the camera from its target, in the axes in which the lamps'
                positions are; None for a camera that follows the robot.

        Raises:
            VideoError: If a mesh cannot be drawn, such as one without normals.
        """
        self._outline = sole_outline(robot.file.sole)
        builder = DiagramBuilder()
        self._scene_graph = builder.AddSystem(SceneGraph())
        self._plant = builder.AddSystem(MultibodyPlant(0.0))
        self._plant.RegisterAsSourceForSceneGraph(self._scene_graph)
        self._robot = robot.add_to(self._plant)
        self._add_ground(terrain)
        add_world(self._plant, world)
        self._plant.Finalize()
        builder.Connect(
            self._plant.get_geometry_pose_output_port(),
            self._scene_graph.get_source_pose_port(self._plant.get_source_id()),
        )
        self._source = self._scene_graph.RegisterSource("footsteps")
        self._diagram = builder.Build()
        self._camera = ColorRenderCamera(
            RenderCameraCore(
                _RENDERER,
                CameraInfo(width, height, np.radians(FIELD_OF_VIEW)),
                ClippingRange(NEAR, FAR),
                RigidTransform(),
            )
        )
        try:
            self._scene_graph.AddRenderer(_RENDERER, MakeRenderEngineVtk(_looks(X_TC)))
        except RuntimeError as error:
            raise VideoError(
                f"--video: Drake's renderer cannot draw robot and world: {error}"
            ) from error
        self._context = self._diagram.CreateDefaultContext()
        self._shown: dict[FootstepMark, GeometryId] = {}
        self._drawn = 0

    @property
    def num_states(self) -> int:
        """Length of the state of robot and world."""
        return self._plant.num_multibody_states()

    @property
    def num_positions(self) -> int:
        """Length of the configuration of robot and world."""
        return self._plant.num_positions()

    def picture(
        self,
        q: NDArray[np.float64],
        marks: Iterable[FootstepMark],
        X_WC: RigidTransform,
    ) -> Picture:
        """Takes one picture.

        Args:
            q: Configuration of robot and world, in plant order.
            marks: Footstep marks in the picture.
            X_WC: Pose of the camera, z ahead and y down.
        """
        context = self._plant.GetMyMutableContextFromRoot(self._context)
        self._plant.SetPositions(context, q)
        self._show(set(marks))
        world = SceneGraph.world_frame_id()
        image = self._query().RenderColorImage(self._camera, world, X_WC)
        return np.array(image.data[:, :, :3])

    def links(self, X_WC: RigidTransform) -> NDArray[np.int16]:
        """Returns which link each pixel of the last picture shows.

        Returns:
            Index of a body in the plant, or another number, shape (height, width).
        """
        world = SceneGraph.world_frame_id()
        # The plant labels the geometries of a body with its index.
        image = self._query().RenderLabelImage(self._camera, world, X_WC)
        return np.array(image.data[:, :, 0])

    def bodies(self, names: Iterable[str]) -> list[int]:
        """Returns the indices of the robot's bodies with these names."""
        return [int(self._plant.GetBodyByName(n, self._robot).index()) for n in names]

    def pixels(
        self, points: NDArray[np.float64], X_WC: RigidTransform
    ) -> NDArray[np.float64] | None:
        """Projects points in W [m], shape (k, 3).

        Returns:
            Column and row of each point [pixel], and its distance ahead of the lens
            [m], shape (k, 3); None if a point is not in front of the camera.
        """
        x, y, z = X_WC.inverse() @ np.asarray(points, dtype=float).T
        if (z < NEAR).any():
            return None
        lens = self._camera.core().intrinsics()
        columns = lens.center_x() + lens.focal_x() * x / z
        rows = lens.center_y() + lens.focal_y() * y / z
        return np.column_stack([columns, rows, z])

    @property
    def focal_length(self) -> float:
        """Size of 1 m at a distance of 1 m [pixel]."""
        return float(self._camera.core().intrinsics().focal_y())

    def _query(self) -> Any:
        own = self._scene_graph.GetMyContextFromRoot(self._context)
        return self._scene_graph.get_query_output_port().Eval(own)

    def _show(self, marks: set[FootstepMark]) -> None:
        context = self._scene_graph.GetMyMutableContextFromRoot(self._context)
        for mark in set(self._shown) - marks:
            geometry = self._shown.pop(mark)
            self._scene_graph.RemoveGeometry(context, self._source, geometry)
        for mark in marks - set(self._shown):
            shape = _mesh(*mark_triangles(mark.kind, self._outline))
            self._drawn += 1
            instance = GeometryInstance(mark.X_WF, shape, str(self._drawn))
            instance.set_perception_properties(_painted(_color(mark)))
            self._shown[mark] = self._scene_graph.RegisterGeometry(
                context, self._source, SceneGraph.world_frame_id(), instance
            )

    def _add_ground(self, terrain: Sequence[Block]) -> None:
        plant, world = self._plant, self._plant.world_body()
        slab = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
        X_WS = RigidTransform([0.0, 0.0, -0.5 * GROUND_THICKNESS])
        plant.RegisterVisualGeometry(world, X_WS, slab, "ground", GROUND_COLOR)
        at = np.arange(-0.5 * GRID_SIZE, 0.5 * GRID_SIZE + 1e-9, GRID_SPACING)
        end, flat = np.full(at.size, 0.5 * GRID_SIZE), np.zeros(at.size)
        starts = np.hstack([[at, -end, flat], [-end, at, flat]])
        ends = np.hstack([[at, end, flat], [end, at, flat]])
        grid = _mesh(*ribbons(starts, ends, GRID_WIDTH))
        X_WG = RigidTransform([0.0, 0.0, GRID_LIFT])
        plant.RegisterVisualGeometry(world, X_WG, grid, "grid", GRID_COLOR)
        for number, block in enumerate(terrain):
            box = Box(np.array(block.size))
            name = f"terrain_{number}"
            plant.RegisterVisualGeometry(world, block.X_WC, box, name, block.rgba)


def _mesh(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Mesh:
    """Writes triangles, visible from above, in the renderer's format."""
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices.T]
    lines.append("vn 0 0 1")
    lines += ["f " + " ".join(f"{i + 1}//1" for i in face) for face in faces.T]
    file = MemoryFile("\n".join(lines) + "\n", ".obj", "triangles")
    return Mesh(InMemoryMesh(mesh_file=file))


def _color(mark: FootstepMark) -> Rgba:
    """Color of a mark; pale if landed, because transparency is not drawn reliably."""
    color = np.array(FEET[mark.foot])
    if mark.kind is Kind.LANDED:
        color = LANDED_OPACITY * color + (1.0 - LANDED_OPACITY) * GROUND_COLOR[:3]
    return Rgba(*color)


def _painted(color: Rgba) -> PerceptionProperties:
    properties = PerceptionProperties()
    properties.AddProperty("phong", "diffuse", color)
    properties.AddProperty("label", "id", RenderLabel.kDontCare)
    return properties


def _looks(X_TC: RigidTransform | None) -> RenderEngineVtkParams:
    """Lamps hang in the camera's frame, so that they follow the robot with it."""
    X_CT = (X_TC or camera_pose(np.zeros(3), 0.0)).inverse()
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
        ],
        cast_shadows=True,
        shadow_map_size=SHADOW_MAP,
    )
