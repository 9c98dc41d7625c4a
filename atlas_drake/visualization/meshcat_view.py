"""Adds all displays of a station in Meshcat to a diagram in one call.

Wiring only; the displays are in the files beside this one.
"""

from __future__ import annotations

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import DiagramBuilder, System

from atlas_drake.robot import Robot
from atlas_drake.visualization import FRAME_RATE
from atlas_drake.visualization.balance_marks import BalanceMarks
from atlas_drake.visualization.caption import CaptionDisplay
from atlas_drake.visualization.contact_forces import ContactForces
from atlas_drake.visualization.control_colors import ControlColors
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.following import Following
from atlas_drake.visualization.footsteps import FootstepDisplay
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import prepare_scene

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
        station: An AtlasStation, or a diagram with some of its output ports.
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
    displays: list[tuple[str, Display]] = [
        (
            "footstep_display",
            FootstepDisplay(meshcat, robot.file.sole, period, recorded),
        ),
        ("caption_display", CaptionDisplay(meshcat, overlays, period, recorded)),
        ("following", Following(meshcat, overlays, period, recorded)),
        ("balance_marks", BalanceMarks(meshcat, robot, overlays, period, recorded)),
        ("contact_force_display", ContactForces(meshcat, overlays, period)),
        (
            "control_colors",
            ControlColors(meshcat, VISUALIZER, robot, overlays, period),
        ),
    ]
    for name, display in displays:
        ports = [display.get_input_port(i) for i in range(display.num_input_ports())]
        # A replay has no contact results.
        if all(station.HasOutputPort(port.get_name()) for port in ports):
            builder.AddNamedSystem(name, display)
            for port in ports:
                builder.Connect(station.GetOutputPort(port.get_name()), port)
