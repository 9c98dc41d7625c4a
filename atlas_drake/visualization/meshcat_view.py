"""Adds all displays of a station in Meshcat to a diagram in one call.

Wiring only; the displays are in the files beside this one.
"""

from __future__ import annotations

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import DiagramBuilder, System

from atlas_drake.robot import Robot
from atlas_drake.visualization import FRAME_RATE
from atlas_drake.visualization.caption import CaptionDisplay
from atlas_drake.visualization.control_colors import ControlColors
from atlas_drake.visualization.footsteps import FootstepDisplay
from atlas_drake.visualization.marks import add_display
from atlas_drake.visualization.overlay_marks import OverlayMarks
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import Following, prepare_scene

VISUALIZER = "/drake/visualizer"
"""Where Drake's own visualiser draws the links."""


def add_meshcat_view(
    builder: DiagramBuilder,
    station: System,
    robot: Robot,
    meshcat: Meshcat,
    overlays: Overlays | None = None,
    recorded: bool = False,
) -> None:
    """Adds the robot's visualiser, footsteps, overlays and caption, and sets the scene.

    Args:
        builder: Builder of the diagram that holds the station.
        station: An AtlasStation, or the replay of one.
        robot: Robot of the station.
        meshcat: Meshcat instance to draw in.
        overlays: Switches of the overlays, which may change later.
        recorded: See ``Marks``.
    """
    overlays = overlays or Overlays()
    period = 1.0 / FRAME_RATE
    prepare_scene(meshcat)
    MeshcatVisualizer.AddToBuilder(
        builder,
        station.GetOutputPort("query_object"),
        meshcat,
        MeshcatVisualizerParams(
            publish_period=period, enable_alpha_slider=False, prefix=VISUALIZER
        ),
    )
    sole = robot.file.sole
    for name, display in (
        ("footstep_display", FootstepDisplay(meshcat, sole, period, recorded)),
        ("caption_display", CaptionDisplay(meshcat, overlays, period, recorded)),
        ("following", Following(meshcat, overlays, period, recorded)),
        ("overlay_marks", OverlayMarks(meshcat, robot, overlays, period, recorded)),
        ("control_colors", ControlColors(meshcat, VISUALIZER, robot, overlays, period)),
    ):
        add_display(builder, station, name, display)
