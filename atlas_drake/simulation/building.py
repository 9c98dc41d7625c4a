"""Builds what an ``AtlasSimulation`` holds from its arguments: diagram, sinks, view."""

from __future__ import annotations

import os
from array import array
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydrake.geometry import Meshcat

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import registered
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.diagrams.atlas_station import StationConfig
from atlas_drake.diagrams.control_mode_switch import Extend, make_control_mode_switch
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.errors import shown
from atlas_drake.messages import AtlasCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.event import Event
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.models import world_of
from atlas_drake.scenario.noise import noise_model
from atlas_drake.scenario.world import WorldMaker, listed
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.sinks import FileSink, Listener, Sink
from atlas_drake.simulation.tutorial import control_mode_switch_programme
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video


@dataclass(frozen=True)
class Built:
    """The parts of a simulation.

    Attributes:
        scenario: The resolved scenario.
        behaviors: Catalog of the shipped behaviors and the user's own.
        own_behaviors: Entries of the user's own behaviors.
        programme: Commands that the scenario sends by itself.
        run: The diagram, at the begin of a run.
        sinks: Log, video and listener, as far as they were asked for.
        meshcat: Meshcat of the 3D view, None without a view.
    """

    scenario: Scenario
    behaviors: BehaviorCatalog
    own_behaviors: tuple[BehaviorEntry, ...]
    programme: tuple[ScheduledCommand, ...]
    run: RunDiagram
    sinks: list[Sink]
    meshcat: Meshcat | None


def build(
    scenario: Scenario | None,
    *,
    controller: ControllerSource | None,
    behaviors: Iterable[BehaviorEntry],
    world: Sequence[WorldMaker],
    extend: Extend | None,
    view: bool | Meshcat | None,
    overlays: Overlays | None,
    recorded: bool,
    video: Video | None,
    on_event: Callable[[Event], None] | None,
    log: str | Path | None,
) -> Built:
    """Builds the parts; arguments and errors are those of ``AtlasSimulation``."""
    _check_arguments(
        scenario=scenario,
        view=view,
        overlays=overlays,
        video=video,
        on_event=on_event,
        log=log,
    )
    own = registered(behaviors)
    scenario = (scenario or Scenario()).resolved(own)
    robot = load_robot(scenario.model)
    catalog = BehaviorCatalog((*SHIPPED_ENTRIES, *own))
    programme = _programme(scenario, robot, catalog)
    world = (*world_of(scenario.all_models()), *listed(world))
    tick_seconds = array("d")
    # The modules for logs and views load only with a log or a view.
    with ExitStack() as on_error:
        recorder = None
        if log is not None:
            from atlas_drake.logs.recorder import start_recorder

            recorder = start_recorder(
                Path(log), scenario, robot, world, tick_seconds, own
            )
            on_error.callback(recorder.close)
        meshcat = view or None
        if meshcat is True:
            from atlas_drake.visualization.viewer import start_meshcat

            meshcat = start_meshcat()
        diagram = make_control_mode_switch(
            robot,
            programme,
            _station_config(scenario),
            meshcat,
            overlays,
            recorded,
            recorder,
            video,
            view=scenario.surroundings().view,
            controller=controller,
            behaviors=own,
            extend=extend,
            world=world,
        )
        run = RunDiagram(robot, scenario, diagram, bool(world), tick_seconds)
        on_error.pop_all()
    sinks: list[Sink] = []
    if recorder is not None:
        sinks.append(FileSink(Path(str(log)), recorder))
    if video is not None:
        film: Any = diagram.GetSubsystemByName("video")
        sinks.append(FileSink(video.path, film))
    if on_event is not None:
        sinks.append(Listener(on_event))
    if meshcat is not None:
        from atlas_drake.visualization.scene import show_start

        show_start(meshcat, scenario)
    return Built(scenario, catalog, own, programme, run, sinks, meshcat)


_RULES: dict[str, tuple[Any, str]] = {
    "scenario": (Scenario, "a Scenario{}; load_scenario reads one from a file"),
    "view": (bool | Meshcat, "True, False or a Meshcat of pydrake.geometry{}"),
    "overlays": (
        Overlays,
        "Overlays of atlas_drake.visualization.overlays{}, such as "
        "Overlays(['com', 'dcm'])",
    ),
    "on_event": (Callable, "a callable (event) -> None{}"),
    "log": (str | os.PathLike, "the name of a file{}, such as 'run.npz'"),
}
"""Type of each argument that no other part checks, and what an error says around the
given value."""


def _check_arguments(**arguments: object) -> None:
    """Checks the types of arguments; None is valid.

    Raises:
        TypeError: Naming the argument and a correct value.
    """
    rules = dict(_RULES)
    if arguments["video"] is not None:
        # The modules for video are loaded only for a run with a video.
        from atlas_drake.visualization.video_display import Video

        rules["video"] = (
            Video,
            "a Video of atlas_drake.visualization.video_display{}, such as "
            "Video('run.mp4')",
        )
    for name, value in arguments.items():
        if value is None:
            continue
        kind, requirement = rules[name]
        if not isinstance(value, kind):
            raise TypeError(
                f"{name} must be {requirement.format(f', is {shown(value)}')}"
            )


def _programme(
    scenario: Scenario, robot: Robot, catalog: BehaviorCatalog
) -> tuple[ScheduledCommand, ...]:
    """Returns the tutorial's and the scenario's own commands, in order of time.

    Raises:
        ScenarioError: If the robot lacks joints that the tutorial commands, or would
            refuse a message.
    """
    programme = []
    if scenario.programme != "none":
        literal = scenario.programme == "tutorial_literal"
        programme = control_mode_switch_programme(robot, literal)
    for index, entry in enumerate(scenario.messages):
        message = entry.message(robot, f"messages[{index}]", catalog)
        if isinstance(message, AtlasCommand):
            kind = "joint command"
        else:
            kind = catalog.find(message.behavior, "behavior").name
        text = entry.text or f"[{kind}]"
        programme.append(ScheduledCommand(entry.time, message, text))
    return tuple(sorted(programme, key=lambda entry: entry.time))


def _station_config(scenario: Scenario) -> StationConfig:
    """Returns what of a scenario concerns the station."""
    return StationConfig(
        physics_step=scenario.physics_step,
        control_period=scenario.control_period,
        ground_friction=scenario.ground_friction,
        terrain=tuple(scenario.all_terrain()),
        plant=scenario.plant,
        controller=scenario.controller_config(),
        estimator=scenario.estimator,
        noise=noise_model(scenario.noise),
        harness=scenario.harness,
        seed=scenario.seed,
        initial_behavior=scenario.behavior(),
        harnessed=scenario.start.harnessed,
        estimated=scenario.state == "estimated",
        pushes=tuple(scenario.pushes),
    )
