"""Plays a log: the 3D view of the run, fed from the log; ``film`` films it.

A diagram without physics: each row of the log sets the state of robot and world.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.rendering import MultibodyPositionToGeometryPose

from atlas_drake.clients.logs.log import Log
from atlas_drake.clients.logs.log_player import LogPlayer
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.worlds.models import world_of
from atlas_drake.worlds.scenery import add_scenery
from atlas_drake.worlds.world import WorldMaker, add_world


def make_replay(
    log: Log,
    meshcat: Meshcat | None = None,
    overlays: Overlays | None = None,
    *,
    world: Sequence[WorldMaker] = (),
) -> Diagram:
    """Builds a diagram that displays a log like the run."""
    builder = DiagramBuilder()
    station = builder.AddNamedSystem("station", make_replay_station(log, world))
    # The modules of the view load only if needed.
    if meshcat is not None:
        from atlas_drake.clients.view.meshcat_view import add_meshcat_view
        from atlas_drake.clients.view.scene import show_start

        add_meshcat_view(builder, station, log.robot, meshcat, overlays)
        show_start(meshcat, log.scenario)
    return builder.Build()


def make_replay_beside(log: Log, meshcat: Meshcat, path: str) -> Diagram:
    """Builds a diagram that draws the robot of a log alone, under a path."""
    from atlas_drake.clients.view.meshcat_view import add_links

    builder = DiagramBuilder()
    replay = make_replay_station(log, robot_alone=True)
    add_links(builder, builder.AddNamedSystem("station", replay), meshcat, path)
    return builder.Build()


def make_replay_station(
    log: Log,
    world: Sequence[WorldMaker] = (),
    extend: Callable[[SceneGraph], object] = lambda _scene_graph: None,
    *,
    robot_alone: bool = False,
) -> Diagram:
    """Makes a diagram with a station's output ports, fed from a log.

    ``world`` comes beside the models of the log's scenario. ``extend`` gets the
    SceneGraph before the diagram is built.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph())
    plant = MultibodyPlant(time_step=0.0)
    source = plant.RegisterAsSourceForSceneGraph(scene_graph)
    log.robot.add_to(plant)
    if not robot_alone:
        scenario = log.scenario
        add_scenery(plant, scenario.all_terrain(), scenario.ground_friction)
        add_world(plant, (*world_of(scenario.all_models()), *world))
    plant.Finalize()
    extend(scene_graph)
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
    return builder.Build()
