"""The tutorial's diagram: an AtlasStation, and a scheduler of commands before it.

Wiring only; the schedule is in ``atlas_drake.simulation.tutorial``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.atlas_station import make_atlas_station, ready
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.errors import AtlasError, shown
from atlas_drake.messages.atlas_command import COMMANDS
from atlas_drake.messages.commands import SCHEDULED
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.shipped import registered
from atlas_drake.systems.command_scheduler import CommandScheduler, ScheduledCommand
from atlas_drake.worlds.world import WorldMaker

Extend = Callable[[DiagramBuilder, Diagram], None]
"""Adds systems to a diagram that holds a station, before it is built."""


def make_control_mode_switch(
    robot: Robot | None = None,
    scenario: Scenario | None = None,
    schedule: Sequence[ScheduledCommand] = (),
    *,
    controller: ControllerSource | None = None,
    behaviors: Iterable[BehaviorEntry] = (),
    world: Iterable[WorldMaker] = (),
    extend: Extend | Iterable[Extend] = (),
) -> Diagram:
    """Builds scheduler and station.

    Args:
        robot: As for ``make_atlas_station``, like the next four.
        scenario: The scenario.
        controller: In place of the shipped controller.
        behaviors: Beside the shipped behaviors.
        world: Callables that add models.
        schedule: Commands of a scheduler with their times; without entries there is
            no scheduler.
        extend: One callable (builder, station) -> None, or a list that is called in
            its order: each adds systems with names of their own, connects them to the
            station, exports ports. It may connect the station's command ports; a
            scheduler has others.

    Input ports, all optional:
        atlas_command, atlas_sim_interface_command: Command ports of the station, unless
            ``extend`` has connected them.
        applied_spatial_force: Forces beside the station's pushes.

    Output ports: those of the station; with a scheduler, its ``sent``.

    Raises:
        AtlasError: If ``extend`` is none of these, or adds what Drake cannot build.
    """
    own_behaviors = registered(behaviors)
    robot, scenario = ready(robot, scenario, own_behaviors)
    builder = DiagramBuilder()
    station = builder.AddNamedSystem(
        "station",
        make_atlas_station(
            robot,
            scenario,
            controller=controller,
            behaviors=own_behaviors,
            world=world,
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
    try:
        for add in additions(extend):
            add(builder, station)
        for name in COMMANDS:
            port = station.GetInputPort(name)
            if not builder.IsConnectedOrExported(port):
                builder.ExportInput(port, name)
        diagram = builder.Build()
    except (RuntimeError, SystemExit) as error:
        # Drake's bindings make a SystemExit of a condition that Drake demands.
        raise AtlasError(
            f"extend adds what Drake cannot build: {error}. Systems and exported ports "
            "need names of their own, and an input port takes one connection"
        ) from error
    diagram.set_name("control_mode_switch")
    return diagram


def additions(extend: Extend | Iterable[Extend]) -> tuple[Extend, ...]:
    """Returns the callables of ``extend``, which is one or a list of them."""
    if callable(extend):
        return (extend,)
    several = tuple(extend) if isinstance(extend, Iterable) else ()
    if not (isinstance(extend, Iterable) and all(map(callable, several))):
        wanted = "a callable (builder, station) -> None, or a list of them"
        raise AtlasError(f"extend must be {wanted}, is {shown(extend)}")
    return several


def _add_scheduler(
    builder: DiagramBuilder,
    station: Diagram,
    schedule: Sequence[ScheduledCommand],
    period: float,
) -> None:
    """Adds what sends the schedule, every ``period`` [s] at most one message."""
    scheduler = builder.AddNamedSystem("scheduler", CommandScheduler(schedule, period))
    for name in COMMANDS:
        port = station.GetInputPort(f"{SCHEDULED}{name}")
        builder.Connect(scheduler.GetOutputPort(name), port)
    for name in ("atlas_state", "atlas_sim_interface_state", "imu"):
        builder.Connect(station.GetOutputPort(name), scheduler.GetInputPort(name))
    builder.ExportOutput(scheduler.GetOutputPort("sent"), "sent")
