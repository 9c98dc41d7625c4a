"""The 3D view of a station in Meshcat: its parts are in the files beside this one."""

from __future__ import annotations

from functools import partial

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import Context, DiagramBuilder, System

from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.visualization.caption import caption_lines, draw_line
from atlas_drake.visualization.control_colors import ControlColors
from atlas_drake.visualization.footsteps import draw_footstep, sole_outline
from atlas_drake.visualization.marks import PERIOD, Marks
from atlas_drake.visualization.overlay_marks import OverlayMarks
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import CAMERA, Following, prepare_scene
from atlas_drake.visualization.seen import ViewInputs, see

VISUALIZER = "/drake/visualizer"
"""Where Drake's own visualiser draws the links."""
PATHS_EVERY = 4
"""Pictures between updates of planned paths."""


class MeshcatView(CollectableSystem):
    """Draws beside Drake's visualiser: footsteps, overlays, caption, colors of links.

    Draws at a fixed rate, and whenever its diagram publishes. Input ports are those of
    ``RecordInputs``.
    """

    def __init__(
        self,
        meshcat: Meshcat,
        robot: Robot,
        catalog: BehaviorCatalog,
        overlays: Overlays,
    ) -> None:
        """Draws in ``meshcat`` what is switched on."""
        super().__init__()
        recorded = overlays.recorded
        self.inputs = ViewInputs(self, overlays, PATHS_EVERY)
        self._see = partial(see, robot=robot, catalog=catalog, overlays=overlays)
        footstep = partial(draw_footstep, meshcat, sole_outline(robot.file.sole))
        line = partial(draw_line, meshcat)
        self._footsteps = Marks(meshcat, "/atlas_drake/footsteps", footstep, recorded)
        self._caption = Marks(meshcat, f"{CAMERA}/caption", line, recorded)
        self._following = Following(meshcat, overlays)
        self._shapes = OverlayMarks(meshcat, recorded)
        self._colors = ControlColors(meshcat, VISUALIZER, robot)
        self.DeclarePeriodicPublishEvent(PERIOD, 0.0, self._publish)
        self.DeclareForcedPublishEvent(self._publish)
        # Drake's visualiser then draws everything anew.
        self.DeclareInitializationPublishEvent(lambda _context: self._colors.begin())

    def _publish(self, context: Context) -> None:
        """Draws the latest record completely, independent of earlier pictures."""
        seen, time = self._see(self.inputs.shown(context)), context.get_time()
        self._footsteps.show(seen.footsteps, time)
        self._caption.show(caption_lines(seen.title, seen.notes), time)
        self._following.show(seen.record)
        self._shapes.show(seen.shapes, time)
        inspector = self.inputs.inspector(context)
        self._colors.show(seen.joint_colors, inspector, time)


def add_meshcat_view(
    builder: DiagramBuilder,
    station: System,
    robot: Robot,
    catalog: BehaviorCatalog,
    meshcat: Meshcat,
    overlays: Overlays | None = None,
) -> None:
    """Adds the robot's visualiser, footsteps, overlays and caption, and sets the scene.

    Args:
        builder: Builder of the diagram that holds the station.
        station: An AtlasStation, or the replay of one.
        robot: Robot of the station.
        catalog: Its behaviors.
        meshcat: Meshcat instance to draw in.
        overlays: Switches of the overlays, which may change later.
    """
    prepare_scene(meshcat)
    MeshcatVisualizer.AddToBuilder(
        builder,
        station.GetOutputPort("query_object"),
        meshcat,
        MeshcatVisualizerParams(
            publish_period=PERIOD, enable_alpha_slider=False, prefix=VISUALIZER
        ),
    )
    view = MeshcatView(meshcat, robot, catalog, overlays or Overlays())
    builder.AddNamedSystem("meshcat_view", view)
    view.inputs.connect(builder, station)
