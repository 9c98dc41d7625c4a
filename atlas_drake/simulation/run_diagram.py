"""The diagram of a scenario with its simulator, and the begin of runs in it.

Events are collected in ``run_log``.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from contextlib import suppress
from typing import Any, TypeAlias

import numpy as np
from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    InitializeParams,
    Simulator,
)
from pydrake.systems.framework import Context

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.atlas_station import reset_station
from atlas_drake.diagrams.control_mode_switch import Extend, make_control_mode_switch
from atlas_drake.diagrams.controller_socket import CONTROLLER, ControllerSource
from atlas_drake.diagrams.standing import place_robot
from atlas_drake.errors import AtlasError
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasCommand, Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.shipped import BEHAVIORS, registered
from atlas_drake.simulation.pace import Pace
from atlas_drake.simulation.start import Variation, draw_variation, scale_masses
from atlas_drake.simulation.tutorial import tutorial_schedule
from atlas_drake.systems.command_scheduler import ScheduledCommand
from atlas_drake.systems.record_reader import RecordListener
from atlas_drake.worlds.models import set_velocities
from atlas_drake.worlds.scenery import set_ground_friction
from atlas_drake.worlds.world import WorldMaker, listed, put_world_back

CLEARANCE = 0.10
"""Height of the feet above the ground on the gantry [m]."""
Pose: TypeAlias = tuple[Sequence[float], float]
"""Position of the pelvis, horizontal in W [m], and its yaw [rad]."""


class SimulationError(AtlasError, RuntimeError):
    """The physics could not be solved any further."""


class RunDiagram:
    """The diagram of a scenario, its simulator and the context of the present run.

    Attributes:
        scenario: Scenario of the present run.
        variation: What the present run drew from its seed.
    """

    def __init__(
        self,
        scenario: Scenario,
        controller: ControllerSource | None,
        behaviors: Iterable[BehaviorEntry],
        world: Iterable[WorldMaker],
        extend: Extend | Iterable[Extend],
    ):
        """Builds the diagram as ``AtlasSimulation`` explains, and begins a run."""
        self.own_behaviors = registered(behaviors)
        world = listed(world)
        scenario = scenario.resolved(self.own_behaviors)
        self.robot = load_robot(scenario.model)
        self.catalog = BehaviorCatalog((*BEHAVIORS, *self.own_behaviors))
        self.schedule = _schedule(scenario, self.robot, self.catalog)
        self.tick_seconds = array("d")
        self.diagram = make_control_mode_switch(
            self.robot,
            scenario,
            self.schedule,
            controller=controller,
            behaviors=self.own_behaviors,
            world=world,
            extend=extend,
        )
        self._terrain, self._models = scenario.all_terrain(), scenario.all_models()
        self._has_world = bool(world or self._models)
        self._trial: Context | None = None
        self.station: Any = self.diagram.GetSubsystemByName("station")
        self.plant: Any = self.station.GetSubsystemByName("plant")
        for name in (CONTROLLER, "tick_recorder"):
            system = self.station.GetSubsystemByName(name)
            if hasattr(system, "tick_seconds"):
                system.tick_seconds = self.tick_seconds
        self.simulator = Simulator(self.diagram)
        ApplySimulatorConfig(scenario.simulator, self.simulator)
        self.pace = Pace(self.simulator)
        self.begin(scenario)

    def part(self, name: str) -> tuple[Any, Context]:
        """Returns a system of the station, and its context."""
        system: Any = self.station.GetSubsystemByName(name)
        return system, system.GetMyMutableContextFromRoot(self.context)

    @property
    def context(self) -> Context:
        """The root context of the diagram."""
        return self.simulator.get_mutable_context()

    @property
    def plant_context(self) -> Context:
        """The context of the plant."""
        return self.plant.GetMyMutableContextFromRoot(self.context)

    def begin(self, scenario: Scenario) -> None:
        """Begins a run at time 0, with what is drawn from the scenario's seed."""
        source, of_source = self.part("push_source")
        pushes = source.schedule(scenario.pushes)
        variation = draw_variation(scenario, self.robot)
        self._check_place(variation, scenario.start)
        self.scenario, self.variation = scenario, variation
        context = self.context
        self.diagram.SetDefaultContext(context)
        context.SetTime(0.0)
        source.begin(of_source, pushes)
        scale_masses(self.plant, self.plant_context, self.robot, variation)
        for name in ("robot_sensors", "inertial_sensor"):
            if self.station.HasSubsystemNamed(name):
                sensor, of_sensor = self.part(name)
                sensor.set_seed(of_sensor, scenario.seed)
        scene_graph, of_scene = self.part("scene_graph")
        friction = variation.ground_friction
        set_ground_friction(self.plant, scene_graph, of_scene, self._terrain, friction)
        set_velocities(self._models, self.plant, self.plant_context)
        self._begin_at(variation, scenario.start)
        self.simulator.Initialize()
        self.pace.forget_all()
        del self.tick_seconds[:]

    def reset(self, behavior: Behavior, start: Start, pose: Pose | None) -> None:
        """Puts robot and world back, to where the run began without a ``pose``.

        Time goes on.
        """
        moved = _moved(self.variation, pose)
        self._check_place(moved, start)
        for system in self.diagram.GetSystems():
            if isinstance(system, RecordListener):
                # A controller that failed gives no record, and is reset all the same.
                with suppress(Exception):
                    system.flush(system.GetMyContextFromRoot(self.context))
        put_world_back(self.plant, self.plant_context, self.robot)
        set_velocities(self._models, self.plant, self.plant_context)
        self._begin_at(moved, start)
        reset_station(self.station, self.context, behavior)

    def restore(
        self, context: Context, scenario: Scenario, variation: Variation
    ) -> None:
        """Takes over time, state and parameters of a context, and its run."""
        try:
            self.diagram.ValidateContext(context)
        except (RuntimeError, ValueError):
            raise ValueError("the snapshot is that of another simulation") from None
        self.context.SetTimeStateAndParametersFrom(context)
        self.scenario, self.variation = scenario, variation
        # Without the events of an initialization; updates that are due now still come.
        self.simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        self.pace.forget_all()

    def drop_schedule(self) -> None:
        """Lets the rest of the schedule count as sent."""
        if self.schedule:
            scheduler: Any = self.diagram.GetSubsystemByName("scheduler")
            scheduler.drop_rest(scheduler.GetMyMutableContextFromRoot(self.context))

    def check_reset(self, scenario: Scenario, start: Start, pose: Pose) -> None:
        """Checks that a run of ``scenario`` could be reset to this pose."""
        variation = draw_variation(scenario, self.robot)
        self._check_place(_moved(variation, pose), start)

    def advance_to(self, t: float) -> None:
        """Simulates until a time [s]."""
        self.pace.forget_lost_time()
        try:
            self.simulator.AdvanceTo(t)
        except RuntimeError as error:
            raise SimulationError(
                f"the simulation stopped at {self.context.get_time():.3f} s: {error}"
                f"{self._wrong_effort()}"
            ) from error

    def _wrong_effort(self) -> str:
        """Names the joint whose effort from the controller is not finite, if any."""
        try:
            wrong = np.flatnonzero(~np.isfinite(self.output("behavior_effort")))
        except Exception:  # What stopped the physics may stop this, too.
            return ""
        if not wrong.size:
            return ""
        joint = self.robot.joint_names[wrong[0]]
        return f" The controller's behavior_effort of {joint} is not finite."

    def output(self, name: str) -> Any:
        """Returns the present value of an output port of the diagram."""
        try:
            port = self.diagram.GetOutputPort(name)
        except (RuntimeError, TypeError) as error:
            raise ValueError(f"there is no output port {name!r}: {error}") from error
        return port.Eval(self.context)

    def _check_place(self, variation: Variation, start: Start) -> None:
        """Tries a place apart from the run; only a model of the world can be there."""
        if not self._has_world:
            return
        if self._trial is None:
            self._trial = self.diagram.CreateDefaultContext()
        self._place(self._trial, variation, start)

    def _place(self, root: Context, variation: Variation, start: Start) -> None:
        """Puts the robot where it begins, in a context of the diagram."""
        place_robot(
            self.plant,
            self.plant.GetMyMutableContextFromRoot(root),
            self.robot,
            position=variation.position,
            rpy=variation.rpy,
            joints=variation.joints,
            terrain=self._terrain,
            clearance=CLEARANCE if start.on_gantry else 0.0,
        )

    def _begin_at(self, variation: Variation, start: Start) -> None:
        """Puts the robot where it begins, and on the gantry if there is one."""
        self._place(self.context, variation, start)
        if not self.station.HasSubsystemNamed("gantry"):
            return
        gantry, context = self.part("gantry")
        if not start.on_gantry:
            gantry.let_go(context)
            return
        own = self.robot.instance(self.plant)
        pelvis = self.plant.GetBodyByName(self.robot.file.pelvis, own)
        X_WP = self.plant.EvalBodyPoseInWorld(self.plant_context, pelvis)
        released = None
        if start.release_time is not None:
            released = self.context.get_time() + start.release_time
        p_WP, R_WP = X_WP.translation(), X_WP.rotation().matrix()
        gantry.hold(context, p_WP, R_WP, CLEARANCE, released)


def _moved(variation: Variation, pose: Pose | None) -> Variation:
    """Returns what a run drew, at another place."""
    if pose is None:
        return variation
    position, yaw = pose
    return replace(
        variation,
        position=np.array(position, dtype=float),
        rpy=np.array([0.0, 0.0, yaw]),
    )


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
