"""The diagram of a scenario with its simulator, and the begin of runs in it.

Events are collected in ``run_log``.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from typing import Any, TypeAlias

import numpy as np
from pydrake.math import RigidTransform
from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    InitializeParams,
    Simulator,
)
from pydrake.systems.framework import Context, Diagram

from atlas_drake.diagrams.controller_socket import CONTROLLER
from atlas_drake.diagrams.standing import place_robot
from atlas_drake.diagrams.station_reset import begin_run, reset_station
from atlas_drake.errors import AtlasError, ScenarioError, did_you_mean
from atlas_drake.frozen import replace
from atlas_drake.messages import Accepted, Behavior, Refusal
from atlas_drake.records import Schema
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.models import set_velocities
from atlas_drake.scenario.world import put_world_back
from atlas_drake.simulation.pace import Pace
from atlas_drake.simulation.start import Variation, draw_variation, scale_masses

CLEARANCE = 0.10
"""Height of the feet above the ground on the gantry [m]."""
Pose: TypeAlias = tuple[Sequence[float], float]
"""Position of the pelvis, horizontal in W [m], and its yaw [rad]."""


class SimulationError(AtlasError, RuntimeError):
    """The physics could not be solved any further."""


class RunDiagram:
    """The diagram of a scenario, its simulator and the context of the present run."""

    def __init__(
        self,
        robot: Robot,
        scenario: Scenario,
        diagram: Diagram,
        has_world: bool,
        tick_seconds: MutableSequence[float],
    ):
        """Begins a run."""
        self.robot, self.diagram, self.tick_seconds = robot, diagram, tick_seconds
        self._terrain = scenario.all_terrain()
        self._models = scenario.all_models()
        self._has_world = has_world
        self._trial: Context | None = None
        self._outputs = {
            diagram.get_output_port(index).get_name(): index
            for index in range(diagram.num_output_ports())
        }
        self.station: Any = diagram.GetSubsystemByName("station")
        self.plant: Any = self.station.GetSubsystemByName("plant")
        self._interface = self.station.GetSubsystemByName("command_interface")
        own = self.station.GetSubsystemByName(CONTROLLER)
        if hasattr(own, "tick_seconds"):
            own.tick_seconds = tick_seconds
        self._recorder: Any = self.station.GetSubsystemByName("tick_recorder")
        self._recorder.tick_seconds = tick_seconds
        self._pushes = self.station.GetSubsystemByName("push_source")
        self._gantry: Any = None
        if scenario.start.on_gantry:
            self._gantry = self.station.GetSubsystemByName("gantry")
        self.simulator = Simulator(diagram)
        ApplySimulatorConfig(scenario.simulator, self.simulator)
        self.pace = Pace(self.simulator)
        self.begin(scenario)

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
        pushes = self._pushes.schedule(scenario.pushes)
        variation = draw_variation(scenario, self.robot)
        self._check_place(variation, scenario.start)
        self.variation = variation
        context = self.context
        self.diagram.SetDefaultContext(context)
        context.SetTime(0.0)
        self._pushes.begin(self._pushes.GetMyMutableContextFromRoot(context), pushes)
        scale_masses(self.plant, self.plant_context, self.robot, variation)
        begin_run(
            self.station,
            context,
            scenario.seed,
            self._terrain,
            variation.ground_friction,
        )
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
        put_world_back(self.plant, self.plant_context, self.robot)
        set_velocities(self._models, self.plant, self.plant_context)
        self._begin_at(moved, start)
        reset_station(self.station, self.context, behavior)

    def restore(self, context: Context, variation: Variation) -> None:
        """Takes over time, state and parameters of a context, and what its run drew."""
        try:
            self.diagram.ValidateContext(context)
        except (RuntimeError, ValueError):
            raise ValueError("the snapshot is that of another simulation") from None
        self.context.SetTimeStateAndParametersFrom(context)
        self.variation = variation
        # Without the events of an initialization; updates that are due now still come.
        self.simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        self.pace.forget_all()

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

    def receive(self, outcome: Accepted | Refusal) -> Refusal | None:
        """Hands over what the door said of a message; returns why it is refused."""
        context = self._interface.GetMyMutableContextFromRoot(self.context)
        return self._interface.receive(context, outcome)

    def push(self, *push: Any) -> None:
        """Pushes a body from now on, as ``PushSource.push``."""
        self._pushes.push(self._pushes.GetMyMutableContextFromRoot(self.context), *push)

    def release(self) -> None:
        """Lets a robot on the gantry down to the ground, and then go."""
        if self._gantry is None:
            raise ScenarioError(
                "start.on_gantry", False, "there is no gantry to release"
            )
        self._gantry.release(self._gantry.GetMyMutableContextFromRoot(self.context))

    def output(self, name: str) -> Any:
        """Returns the present value of an output port of the diagram."""
        index = self._outputs.get(name) if isinstance(name, str) else None
        if index is None:
            raise ValueError(
                f"there is no output port {name!r}."
                f"{did_you_mean(str(name), self._outputs)} "
                f"Known are {', '.join(self._outputs)}"
            )
        return self.diagram.get_output_port(index).Eval(self.context)

    @property
    def schema(self) -> Schema:
        """The schema of the records."""
        schema: Schema = self._recorder.schema
        return schema

    def events_since(self, marks: Sequence[float]) -> tuple[Any, Sequence[float]]:
        """Returns the station's events since the marks, and the present marks."""
        context = self._recorder.GetMyContextFromRoot(self.context)
        events, now = self._recorder.events_since(context, marks)
        return events, now

    def frame_pose(self, name: str) -> RigidTransform:
        """Returns the pose in W of a body or frame of the robot."""
        own = self.robot.instance(self.plant)
        if not (isinstance(name, str) and self.plant.HasFrameNamed(name, own)):
            indices = self.plant.GetFrameIndices(own)
            known = [self.plant.get_frame(index).name() for index in indices]
            raise ValueError(
                f"{self.robot.name} has no frame {name!r}."
                f"{did_you_mean(str(name), known)} Known are {', '.join(known)}"
            )
        frame = self.plant.GetFrameByName(name, own)
        return frame.CalcPoseInWorld(self.plant_context)

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
        if self._gantry is None:
            return
        context = self._gantry.GetMyMutableContextFromRoot(self.context)
        if not start.on_gantry:
            self._gantry.let_go(context)
            return
        own = self.robot.instance(self.plant)
        pelvis = self.plant.GetBodyByName(self.robot.file.pelvis, own)
        X_WP = self.plant.EvalBodyPoseInWorld(self.plant_context, pelvis)
        released = None
        if start.release_time is not None:
            released = self.context.get_time() + start.release_time
        p_WP, R_WP = X_WP.translation(), X_WP.rotation().matrix()
        self._gantry.hold(context, p_WP, R_WP, CLEARANCE, released)


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
