"""The tutorial's diagram: an AtlasStation, and a scheduler of commands before it.

Wiring only; the schedule is in ``atlas_drake.simulation.tutorial``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.behaviors.registration import registered
from atlas_drake.diagrams.atlas_station import make_atlas_station, ready
from atlas_drake.diagrams.parts import Extend, Parts
from atlas_drake.errors import AtlasError, shown
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.systems.command_scheduler import CommandScheduler, ScheduledCommand


def make_control_mode_switch(
    robot: Robot | None = None,
    scenario: Scenario | None = None,
    schedule: Sequence[ScheduledCommand] = (),
    parts: Parts | None = None,
    displays: Iterable[Extend] = (),
) -> Diagram:
    """Builds scheduler and station.

    Args:
        robot: As for ``make_atlas_station``.
        scenario: As for ``make_atlas_station``.
        schedule: Commands of a scheduler with their times; without entries there is
            no scheduler.
        parts: Parts of the user's own. ``extend`` adds systems with names of their own,
            connects them to the station, exports ports. It may connect the station's
            command ports, where no scheduler does.
        displays: Callables (builder, station) -> None that add views and logs, before
            ``extend`` is called.

    Input ports, all optional:
        atlas_command, atlas_sim_interface_command: Command ports of the station, unless
            a scheduler or ``extend`` has connected them.
        applied_spatial_force: Forces beside the station's pushes.

    Output ports: those of the station; with a scheduler, its ``sent``.

    Raises:
        AtlasError: If ``extend`` is no callable, or adds what Drake cannot build.
    """
    parts = parts or Parts()
    own_behaviors = registered(parts.behaviors)
    robot, scenario = ready(robot, scenario, own_behaviors)
    builder = DiagramBuilder()
    station = builder.AddNamedSystem(
        "station",
        make_atlas_station(
            robot,
            scenario,
            controller=parts.controller,
            behaviors=own_behaviors,
            world=parts.world,
        ),
    )
    if schedule:
        _add_scheduler(builder, station, schedule, scenario.control_period)
    builder.ExportInput(
        station.GetInputPort("applied_spatial_force"), "applied_spatial_force"
    )
    for index in range(station.num_output_ports()):
        port = station.get_output_port(index)
        builder.ExportOutput(port, port.get_name())
    for add in displays:
        add(builder, station)
    if parts.extend is not None:
        if not callable(parts.extend):
            raise AtlasError(
                "extend must be a callable (builder, station) -> None, is "
                f"{shown(parts.extend)}"
            )
        _extended(builder, station, parts.extend)
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
    """Lets a user's callable add to the diagram."""
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
