"""The tutorial's diagram: an AtlasStation, and a scheduler of commands before it.

Wiring only; the schedule is in ``atlas_drake.simulation.tutorial``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from pydrake.geometry import Meshcat
from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.atlas_station import StationConfig, make_atlas_station
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.errors import AtlasError, shown
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario.world import WorldMaker
from atlas_drake.scenario.world_file import View
from atlas_drake.systems.command_scheduler import CommandScheduler, ScheduledCommand
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.logs.recorder import LogRecorder
    from atlas_drake.visualization.video_display import Video


Extend = Callable[[DiagramBuilder, Diagram], None]
"""Adds systems to a diagram that holds a station, before it is built."""


def make_control_mode_switch(
    robot: Robot | None = None,
    schedule: Sequence[ScheduledCommand] = (),
    config: StationConfig | None = None,
    meshcat: Meshcat | None = None,
    overlays: Overlays | None = None,
    recorded: bool = False,
    recorder: LogRecorder | None = None,
    video: Video | None = None,
    *,
    view: View | None = None,
    controller: ControllerSource | None = None,
    behaviors: Iterable[BehaviorEntry] = (),
    extend: Extend | None = None,
    world: Sequence[WorldMaker] = (),
) -> Diagram:
    """Builds scheduler and station; 3D view, recorder and video if they are given.

    Args:
        robot: Robot of the station; None is ``atlas``.
        schedule: Commands of a scheduler with their times; without entries there is
            no scheduler.
        config: Settings of the station; None for the defaults.
        meshcat: Meshcat instance to draw in; None for no 3D view.
        overlays: Switches of the overlays in 3D view and video.
        recorded: True if Meshcat records.
        recorder: Writer of a log; None for no log.
        video: Settings of a video; None for no video.
        view: Camera of the video; None for a camera that follows the robot.
        controller: As for ``make_atlas_station``.
        behaviors: As for ``make_atlas_station``.
        world: As for ``make_atlas_station``; called for the video's scene, too.
        extend: Called with (builder, station) before the diagram is built: adds
            systems with names of their own, connects them to the station, exports
            ports. It may connect the station's command ports, where no scheduler does.

    Input ports, all optional:
        atlas_command, atlas_sim_interface_command: Command ports of the station, unless
            a scheduler or ``extend`` has connected them.
        applied_spatial_force: Forces beside the station's pushes.

    Output ports: those of the station; with a scheduler, its ``sent``.

    Raises:
        AtlasError: If ``extend`` is no callable, or adds what Drake cannot build.
    """
    robot = robot or load_robot()
    config = config or StationConfig()
    builder = DiagramBuilder()
    station = builder.AddNamedSystem(
        "station",
        make_atlas_station(
            robot, config, controller=controller, behaviors=behaviors, world=world
        ),
    )
    if schedule:
        _add_scheduler(builder, station, schedule, config.control_period)
    builder.ExportInput(
        station.GetInputPort("applied_spatial_force"), "applied_spatial_force"
    )
    for index in range(station.num_output_ports()):
        port = station.get_output_port(index)
        builder.ExportOutput(port, port.get_name())
    if meshcat is not None:
        # The modules for Meshcat load only with a 3D view.
        from atlas_drake.visualization.meshcat_view import add_meshcat_view

        add_meshcat_view(builder, station, robot, meshcat, overlays, recorded)
    if recorder is not None:
        from atlas_drake.logs.recorder import add_log_recorder

        add_log_recorder(builder, station, recorder)
    if video is not None:
        from atlas_drake.visualization.video_display import add_video

        terrain = config.terrain
        add_video(builder, station, robot, terrain, video, world, overlays, view)
    if extend is not None:
        if not callable(extend):
            raise AtlasError(
                "extend must be a callable (builder, station) -> None, is "
                f"{shown(extend)}"
            )
        _extended(builder, station, extend)
    for name in COMMAND_PORTS:
        port = station.GetInputPort(name)
        if not builder.IsConnectedOrExported(port):
            builder.ExportInput(port, name)
    try:
        diagram = builder.Build()
    except RuntimeError as error:  # What is exported, Drake checks only here.
        raise AtlasError(
            f"extend adds what Drake cannot build: {error}; give each port a name of "
            "its own"
        ) from error
    diagram.set_name("control_mode_switch")
    return diagram


COMMAND_PORTS = ("atlas_command", "atlas_sim_interface_command")
"""Input ports of the station that take messages."""


def _add_scheduler(
    builder: DiagramBuilder,
    station: Diagram,
    schedule: Sequence[ScheduledCommand],
    period: float,
) -> None:
    """Adds what sends the schedule, every ``period`` [s] at most one message."""
    scheduler = builder.AddNamedSystem("scheduler", CommandScheduler(schedule, period))
    for name in COMMAND_PORTS:
        builder.Connect(scheduler.GetOutputPort(name), station.GetInputPort(name))
    for name in ("atlas_state", "atlas_sim_interface_state", "imu"):
        builder.Connect(station.GetOutputPort(name), scheduler.GetInputPort(name))
    builder.ExportOutput(scheduler.GetOutputPort("sent"), "sent")


def _extended(builder: DiagramBuilder, station: Diagram, extend: Extend) -> None:
    """Lets a user's callable add to the diagram.

    Raises:
        AtlasError: If Drake could not build the diagram after that; on names that are
            there twice it would end the program.
    """
    ours = {system.get_name() for system in builder.GetSystems()}
    try:
        extend(builder, station)
    except SystemExit as error:
        # What Drake's bindings make of a condition that Drake demands.
        raise AtlasError(
            f"extend adds what Drake cannot build: {error}. An input port takes one "
            "connection; a schedule is connected to the station's command ports"
        ) from error
    if builder.already_built():
        raise AtlasError("extend must not build the diagram; it is built afterwards")
    names = [system.get_name() for system in builder.GetSystems()]
    for name in names:
        if names.count(name) > 1:
            whose = "the simulation has one" if name in ours else "it adds two"
            raise AtlasError(
                f"extend adds a system named {name!r}, but {whose} of this name; give "
                "each system a name of its own"
            )
