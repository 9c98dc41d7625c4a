"""Plays a log: the same 3D view and video as of the run, fed from the log.

A diagram without physics: the robot is put where the log says it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.rendering import MultibodyPositionToGeometryPose

from atlas_drake.diagrams.atlas_station import add_scenery
from atlas_drake.logs.log import Log
from atlas_drake.logs.log_player import LogPlayer
from atlas_drake.scenario.models import world_of
from atlas_drake.scenario.world import WorldMaker, add_world
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video


def make_replay(
    log: Log,
    meshcat: Meshcat | None = None,
    overlays: Overlays | None = None,
    video: Video | None = None,
    *,
    recorded: bool = False,
    world: Sequence[WorldMaker] = (),
) -> Diagram:
    """Builds a diagram that shows a log as the run was shown.

    Args:
        log: Of the run.
        meshcat: Where to show it; None shows nothing.
        overlays: What is shown besides, of ``LOGGED``.
        video: What to film it into; None films nothing.
        recorded: Whether Meshcat records, see ``add_meshcat_view``.
        world: The callables that the run had. A log knows how the models of the
            scenario look, of others only how they moved.

    Raises:
        LogError: If the log lacks what is to be shown, or has a scenario that is
            unknown to this program.
        VideoError: If the video cannot be made.
    """
    builder = DiagramBuilder()
    robot = log.robot  # Of what is missing it is the first to be told of.
    world = (*world_of(log.scenario.all_models()), *world)
    builder.AddNamedSystem("station", _make_station(log, world))
    station: Any = builder.GetSubsystemByName("station")
    # What displays need loads only where there is one.
    if meshcat is not None:
        from atlas_drake.visualization.meshcat_view import add_meshcat_view
        from atlas_drake.visualization.scene import show_start

        add_meshcat_view(builder, station, robot, meshcat, overlays, recorded=recorded)
        show_start(meshcat, log.scenario)
    if video is not None:
        from atlas_drake.visualization.video_display import add_video

        add_video(builder, station, robot, log.scenario.all_terrain(), video, world)
    diagram = builder.Build()
    diagram.set_name("replay")
    return diagram


def _make_station(log: Log, world: Sequence[WorldMaker]) -> Diagram:
    """What looks like a station from outside, with a log in place of physics."""
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph())
    plant = MultibodyPlant(time_step=0.0)
    source = plant.RegisterAsSourceForSceneGraph(scene_graph)
    log.robot.add_to(plant)
    scenario = log.scenario
    add_scenery(plant, scenario.all_terrain(), scenario.ground_friction)
    add_world(plant, world)
    plant.Finalize()
    player = builder.AddNamedSystem("log_player", LogPlayer(log, plant))
    poses = builder.AddNamedSystem(
        "poses", MultibodyPositionToGeometryPose(plant, input_multibody_state=True)
    )
    builder.Connect(player.GetOutputPort("plant_state"), poses.get_input_port())
    builder.Connect(poses.get_output_port(), scene_graph.get_source_pose_port(source))
    for index in range(player.num_output_ports()):
        port = player.get_output_port(index)
        builder.ExportOutput(port, port.get_name())
    builder.ExportOutput(scene_graph.get_query_output_port(), "query_object")
    station = builder.Build()
    station.set_name("ReplayStation")
    return station
