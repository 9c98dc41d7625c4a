"""The 3D view of a station in Meshcat: its parts are in the files beside this one."""

from __future__ import annotations

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import Context, DiagramBuilder, System

from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.colors import LinkColors, joint_colors
from atlas_drake.clients.view.meshcat_shapes import MeshcatShapes
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.scene import Following, prepare_scene
from atlas_drake.clients.view.shapes import shapes_of
from atlas_drake.frozen import replace
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.records import TickRecord
from atlas_drake.robot import Robot
from atlas_drake.simulation.sockets import CollectableSystem, RecordInputs

VISUALIZER = "/drake/visualizer"
"""Where Drake's own visualizer draws the links."""
PATHS_EVERY = 4
"""Pictures between updates of planned paths, which are slow to compute and change
slowly."""


class MeshcatView(CollectableSystem):
    """Draws beside Drake's visualizer: footsteps, overlays, colors of links.

    Draws at a fixed rate, and whenever its diagram publishes. The paths that were read
    last belong to the view and not to the Context, as all that it draws. Input ports
    are those of ``RecordInputs``.
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, robot: Robot, overlays: Overlays) -> None:
        """Draws in ``meshcat`` what is switched on."""
        super().__init__()
        self.inputs = RecordInputs(self)
        self._robot, self._overlays = robot, overlays
        self._pictures = 0
        self._paths: PlannedPaths | None = None
        self._following = Following(meshcat, overlays)
        self._shapes = MeshcatShapes(meshcat, overlays.recorded)
        self._colors = LinkColors(meshcat, VISUALIZER, robot)
        self.DeclarePeriodicPublishEvent(1.0 / FRAME_RATE, 0.0, self._publish)
        self.DeclareForcedPublishEvent(self._publish)
        # Drake's visualizer then draws everything anew.
        self.DeclareInitializationPublishEvent(lambda _context: self._colors.begin())

    def _publish(self, context: Context) -> None:
        """Draws the latest record completely, independent of earlier pictures."""
        on, time = self._overlays.on, context.get_time()
        record = self._record(context)
        self._following.show(record)
        self._shapes.show(shapes_of(record, on, self._robot.file.sole), time)
        inspector = self.inputs.inspector(context)
        self._colors.show(joint_colors(record, on, self._robot), inspector, time)

    def _record(self, context: Context) -> TickRecord:
        """Returns the latest record; its costly parts only if they are shown."""
        record, on = self.inputs.record(context), self._overlays.on
        if "forces" in on:
            record = self.inputs.with_contacts(record, context)
        if record.paths is not None:  # Of a replay.
            return record
        if on.isdisjoint(("plan", "swing")):
            self._paths = None
            return record
        if self._paths is None or self._pictures % PATHS_EVERY == 0:
            self._paths = self.inputs.with_paths(record, context).paths
        self._pictures += 1
        return replace(record, paths=self._paths)


def add_links(
    builder: DiagramBuilder, station: System, meshcat: Meshcat, path: str
) -> None:
    """Adds Drake's own visualizer, which draws the links under a path."""
    MeshcatVisualizer.AddToBuilder(
        builder,
        station.GetOutputPort("query_object"),
        meshcat,
        MeshcatVisualizerParams(
            publish_period=1.0 / FRAME_RATE, enable_alpha_slider=False, prefix=path
        ),
    )


def add_meshcat_view(
    builder: DiagramBuilder,
    station: System,
    robot: Robot,
    meshcat: Meshcat,
    overlays: Overlays | None = None,
) -> None:
    """Adds the robot's visualizer, footsteps and overlays, and sets the scene."""
    prepare_scene(meshcat)
    add_links(builder, station, meshcat, VISUALIZER)
    view = MeshcatView(meshcat, robot, overlays or Overlays())
    builder.AddNamedSystem("meshcat_view", view)
    view.inputs.connect(builder, station)
