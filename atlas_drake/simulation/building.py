"""Builds what an ``AtlasSimulation`` holds from its arguments: diagram, sinks, view."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydrake.geometry import Meshcat

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import registered
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch
from atlas_drake.diagrams.parts import Extend, Parts
from atlas_drake.errors import shown
from atlas_drake.messages import AtlasCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.models import world_of
from atlas_drake.scenario.world import listed
from atlas_drake.simulation.outputs import Outputs
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.sinks import Listener, LogSink, Sink
from atlas_drake.simulation.tutorial import tutorial_schedule
from atlas_drake.systems.command_scheduler import ScheduledCommand

if TYPE_CHECKING:
    from atlas_drake.logs.mcap_writer import McapWriter


@dataclass(frozen=True)
class Built:
    """What a simulation consists of.

    Attributes:
        scenario: The resolved scenario.
        behaviors: Catalog of the shipped behaviors and the user's own.
        own_behaviors: Entries of the user's own behaviors.
        schedule: Commands that the scenario sends by itself.
        run: The diagram, at the begin of a run.
        sinks: Log and listener, as far as they were asked for.
        meshcat: Meshcat of the 3D view, None without a view.
    """

    scenario: Scenario
    behaviors: BehaviorCatalog
    own_behaviors: tuple[BehaviorEntry, ...]
    schedule: tuple[ScheduledCommand, ...]
    run: RunDiagram
    sinks: list[Sink]
    meshcat: Meshcat | None


def build(scenario: Scenario | None, parts: Parts, outputs: Outputs) -> Built:
    """Builds a simulation; errors are those of ``AtlasSimulation``."""
    if scenario is not None and not isinstance(scenario, Scenario):
        raise TypeError(
            f"scenario must be a Scenario, is {shown(scenario)}; load_scenario reads "
            "one from a file"
        )
    own = registered(parts.behaviors)
    parts = replace(parts, behaviors=own, world=listed(parts.world))
    scenario = (scenario or Scenario()).resolved(own)
    robot = load_robot(scenario.model)
    catalog = BehaviorCatalog((*SHIPPED_ENTRIES, *own))
    schedule = _schedule(scenario, robot, catalog)
    world = (*world_of(scenario.all_models()), *parts.world)
    tick_seconds = array("d")
    # The modules for logs and views load only with a log or a view.
    with ExitStack() as on_error:
        writer = None
        if outputs.log is not None:
            from atlas_drake.logs.mcap_writer import McapWriter, header_of

            header = header_of(scenario, robot, own)
            writer = McapWriter(Path(outputs.log), header, scenario.log)
            on_error.callback(writer.close)
        meshcat = outputs.view or None
        if meshcat is True:
            from atlas_drake.visualization.viewer import start_meshcat

            meshcat = start_meshcat()
        displays = _displays(robot, outputs, meshcat, writer)
        diagram = make_control_mode_switch(robot, scenario, schedule, parts, displays)
        run = RunDiagram(robot, scenario, diagram, bool(world), tick_seconds)
        on_error.pop_all()
    sinks: list[Sink] = []
    if writer is not None:
        listener: Any = diagram.GetSubsystemByName("log")
        recorder: Any = run.station.GetSubsystemByName("tick_recorder")
        sinks.append(LogSink(writer, listener, recorder))
    if outputs.on_event is not None:
        sinks.append(Listener(outputs.on_event))
    if meshcat is not None:
        from atlas_drake.visualization.scene import show_start

        show_start(meshcat, scenario)
    return Built(scenario, catalog, own, schedule, run, sinks, meshcat)


def _displays(
    robot: Robot,
    outputs: Outputs,
    meshcat: Meshcat | None,
    writer: McapWriter | None,
) -> Iterator[Extend]:
    """Yields what adds 3D view and log to a diagram, as far as there are any."""
    if meshcat is not None:
        from atlas_drake.visualization.meshcat_view import add_meshcat_view

        yield partial(
            add_meshcat_view,
            robot=robot,
            meshcat=meshcat,
            overlays=outputs.overlays,
        )
    if writer is not None:
        from atlas_drake.logs.mcap_writer import add_log

        yield partial(add_log, writer=writer)


def _schedule(
    scenario: Scenario, robot: Robot, catalog: BehaviorCatalog
) -> tuple[ScheduledCommand, ...]:
    """Returns the tutorial's and the scenario's own commands, in order of time.

    Raises:
        ScenarioError: If the robot lacks joints that the tutorial commands, or would
            refuse a message.
    """
    schedule = []
    if scenario.schedule != "none":
        literal = scenario.schedule == "tutorial_literal"
        schedule = tutorial_schedule(robot, literal)
    for index, entry in enumerate(scenario.messages):
        message = entry.message(robot, f"messages[{index}]", catalog)
        if isinstance(message, AtlasCommand):
            kind = "joint command"
        else:
            kind = catalog.find(message.behavior, "behavior").name
        text = entry.text or f"[{kind}]"
        schedule.append(ScheduledCommand(entry.time, message, text))
    return tuple(sorted(schedule, key=lambda entry: entry.time))
