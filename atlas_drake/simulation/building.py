"""Builds what an ``AtlasSimulation`` holds from its arguments: diagram, log, view."""

from __future__ import annotations

import os
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
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.run_log import LogFile
from atlas_drake.simulation.tutorial import tutorial_schedule
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.logs.mcap_writer import McapWriter


@dataclass(frozen=True)
class Built:
    """What a simulation consists of."""

    scenario: Scenario
    behaviors: BehaviorCatalog
    own_behaviors: tuple[BehaviorEntry, ...]
    schedule: tuple[ScheduledCommand, ...]
    run: RunDiagram
    file: LogFile | None
    meshcat: Meshcat | None


def build(
    scenario: Scenario | None,
    parts: Parts,
    view: bool | Meshcat | None,
    overlays: Overlays | None,
    log: str | Path | None,
) -> Built:
    """Builds a simulation; arguments and errors are those of ``AtlasSimulation``."""
    check_type("scenario", scenario, Scenario)
    check_type("view", view, bool | Meshcat)
    check_type("overlays", overlays, Overlays)
    check_type("log", log, str | os.PathLike)
    own = registered(parts.behaviors)
    parts = replace(parts, behaviors=own, world=listed(parts.world))
    scenario = (scenario or Scenario()).resolved(own)
    robot = load_robot(scenario.model)
    catalog = BehaviorCatalog((*SHIPPED_ENTRIES, *own))
    schedule = _schedule(scenario, robot, catalog)
    world = (*world_of(scenario.all_models()), *parts.world)
    # The modules for logs and views load only with a log or a view.
    with ExitStack() as on_error:
        writer = None
        if log is not None:
            from atlas_drake.logs.mcap_writer import McapWriter, header_of

            header = header_of(scenario, robot, own)
            writer = McapWriter(Path(log), header, scenario.log)
            on_error.callback(writer.close)
        meshcat = view or None
        if meshcat is True:
            from atlas_drake.visualization.viewer import start_meshcat

            meshcat = start_meshcat()
        displays = _displays(robot, meshcat, overlays, writer)
        diagram = make_control_mode_switch(robot, scenario, schedule, parts, displays)
        run = RunDiagram(robot, scenario, diagram, bool(world), array("d"))
        on_error.pop_all()
    file = None
    if writer is not None:
        listener: Any = diagram.GetSubsystemByName("log")
        recorder: Any = run.station.GetSubsystemByName("tick_recorder")
        file = LogFile(writer, listener, recorder)
    if meshcat is not None:
        from atlas_drake.visualization.scene import show_start

        show_start(meshcat, scenario)
    return Built(scenario, catalog, own, schedule, run, file, meshcat)


def check_type(name: str, value: object, kind: Any) -> None:
    """Raises TypeError unless an argument is None or of this type."""
    if value is not None and not isinstance(value, kind):
        wanted = getattr(kind, "__name__", str(kind))
        raise TypeError(f"{name} must be of type {wanted}, is {shown(value)}")


def _displays(
    robot: Robot,
    meshcat: Meshcat | None,
    overlays: Overlays | None,
    writer: McapWriter | None,
) -> Iterator[Extend]:
    """Yields what adds 3D view and log to a diagram, as far as there are any."""
    if meshcat is not None:
        from atlas_drake.visualization.meshcat_view import add_meshcat_view

        yield partial(
            add_meshcat_view,
            robot=robot,
            meshcat=meshcat,
            overlays=overlays,
        )
    if writer is not None:
        from atlas_drake.logs.mcap_writer import add_log

        yield partial(add_log, writer=writer)


def _schedule(
    scenario: Scenario, robot: Robot, catalog: BehaviorCatalog
) -> tuple[ScheduledCommand, ...]:
    """Returns the tutorial's and the scenario's own commands, in order of time."""
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
