"""The front door for Python: one robot, one diagram, one simulator.

A thin facade: it builds the diagram of a scenario, passes messages in, advances time
and reads messages out. It holds no control law.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context

from atlas_drake.behaviors.base import Event
from atlas_drake.diagrams.atlas_station import StationConfig
from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch
from atlas_drake.errors import AtlasError, InvalidMessageError
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Behavior,
    Imu,
    Message,
    validate_atlas_command,
    validate_sim_interface_command,
)
from atlas_drake.noise import NOISE_MODELS
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.start import draw_variation, place_robot
from atlas_drake.steady import steady_ticks
from atlas_drake.summary import make_summary
from atlas_drake.tutorial import control_mode_switch_programme

CHUNK = 0.02
"""Simulated time between looks at events, pushes and Ctrl-C [s]."""


@dataclass(frozen=True)
class _Push:
    body: str
    force_W: np.ndarray
    end: float


class AtlasSimulation:
    """A simulated Atlas with joint controllers and behaviours.

    Example:
        >>> sim = AtlasSimulation()
        >>> command = AtlasSimInterfaceCommand()
        >>> command.behavior = command.STAND
        >>> sim.publish(command)
        >>> sim.advance(2.0)
        >>> sim.atlas_sim_interface_state.current_behavior
    """

    def __init__(
        self,
        scenario: Scenario | None = None,
        *,
        meshcat: Meshcat | None = None,
        on_event: Callable[[Event], None] | None = None,
    ):
        """Builds the diagram and puts the robot on its feet.

        Args:
            scenario: What to simulate; None is a robot that stands, commanded by
                nobody but the caller.
            meshcat: Where to show it; None shows nothing.
            on_event: Called with each event as it is noticed.

        Raises:
            ScenarioError: If the scenario has a value that cannot be used.
        """
        self.scenario = (scenario or Scenario()).validate()
        self.robot = load_robot(self.scenario.model)
        self.events: list[Event] = []
        self.footsteps: list[dict[str, Any]] = []
        self._on_event = on_event
        self._meshcat = meshcat
        self._pushes: list[_Push] = []
        self._seen_events = 0
        self._seen_sent = 0
        self._seen_refusals = 0
        self._wall_time = 0.0

        variation = draw_variation(self.scenario, self.robot)
        config = StationConfig(
            physics_step=self.scenario.physics_step,
            control_period=self.scenario.control_period,
            ground_friction=variation.ground_friction,
            terrain=tuple(self.scenario.terrain),
            contact_approximation=self.scenario.contact_approximation,
            noise=NOISE_MODELS[self.scenario.noise],
            seed=self.scenario.seed,
            initial_behavior=self.scenario.behavior(),
        )
        programme = []
        if self.scenario.programme != "none":
            programme = control_mode_switch_programme(
                self.robot, literal=self.scenario.programme == "tutorial_literal"
            )
        self.diagram = make_control_mode_switch(self.robot, programme, config, meshcat)
        self.station = self.diagram.GetSubsystemByName("station")
        self.plant = self.station.GetSubsystemByName("plant")
        self._scheduler = self.diagram.GetSubsystemByName("scheduler")
        self._controller = self.station.GetSubsystemByName("behavior_controller")
        self._controller.tick_seconds = []
        self.simulator = Simulator(self.diagram)
        place_robot(
            self.plant,
            self._plant_context(),
            self.robot,
            variation,
            self.scenario.terrain,
        )
        self.simulator.Initialize()

    # ---- commands ------------------------------------------------------------

    def publish(self, message: AtlasCommand | AtlasSimInterfaceCommand) -> None:
        """Sends a command; it takes effect at the next control update.

        The message is copied: the caller may go on changing and sending it. Of two
        messages of one kind sent at the same instant the second counts.

        Raises:
            InvalidMessageError: If the message cannot be applied. The robot then
                reports the error's code, and what was in force stays in force.
            TypeError: If it is no command.
        """
        force = self._output("commands")
        names = self.robot.joint_names
        if isinstance(message, AtlasCommand):
            self._send("other_atlas_command", message)
            validate_atlas_command(message, names, force.atlas_stamp)
        elif isinstance(message, AtlasSimInterfaceCommand):
            self._send("other_atlas_sim_interface_command", message)
            validate_sim_interface_command(message, names, force.sim_stamp)
        else:
            raise TypeError(
                "publish takes an AtlasCommand or an AtlasSimInterfaceCommand, not "
                f"{type(message).__name__}"
            )

    def _send(self, port: str, message: Message) -> None:
        """Puts a copy on the port also if it is faulty: the robot refuses it itself."""
        self.diagram.GetInputPort(port).FixValue(self.context, message.snapshot())

    def apply_push(
        self, body: str, force_W: Sequence[float] | np.ndarray, duration: float
    ) -> None:
        """Pushes a body at its origin from now on.

        Args:
            body: Name of a link, such as ``utorso``.
            force_W: Force in W [N], shape (3,).
            duration: How long [s], positive.

        Raises:
            InvalidMessageError: If there is no such body or a value is no number.
        """
        force = np.asarray(force_W, dtype=float)
        if force.shape != (3,) or not np.isfinite(force).all():
            raise InvalidMessageError(
                "force_W", force_W, "must be three finite numbers"
            )
        if not (np.isfinite(duration) and duration > 0.0):
            raise InvalidMessageError("duration", duration, "must be positive")
        if not self.plant.HasBodyNamed(body):
            raise InvalidMessageError("body", body, f"the robot has no body {body!r}")
        self._pushes.append(_Push(body, force, self.time + duration))
        text = f"push of {np.round(force, 1).tolist()} N on {body} for {duration:g} s"
        self._note(Event(self.time, "push", text))

    # ---- time ----------------------------------------------------------------

    def advance(self, seconds: float) -> None:
        """Simulates for ``seconds``."""
        self.advance_to(self.time + seconds)

    def advance_to(self, t: float) -> None:
        """Simulates until time ``t`` [s].

        Raises:
            ValueError: If ``t`` is in the past.
            SimulationError: If the physics could not be solved; what was recorded
                until then is kept.
        """
        if not np.isfinite(t) or t < self.time - 1e-9:
            raise ValueError(
                f"cannot advance to {t!r}: it is {self.time:.3f} s already"
            )
        begin = time.perf_counter()
        try:
            with steady_ticks():
                while self.time < t - 1e-9:
                    self._advance_chunk(t)
        except RuntimeError as error:
            raise SimulationError(
                f"the simulation stopped at {self.time:.3f} s: {error}"
            ) from error
        finally:
            self._wall_time += time.perf_counter() - begin

    def _advance_chunk(self, t: float) -> None:
        """Simulates until the next look at the events, at most until ``t``."""
        self._exert_pushes()
        stops = [t, self.time + CHUNK, *(push.end for push in self._pushes)]
        self.simulator.AdvanceTo(min(stop for stop in stops if stop > self.time + 1e-9))
        self._collect_events()

    def set_realtime_rate(self, rate: float) -> None:
        """Keeps simulated time at ``rate`` times real time; 0 is as fast as can be."""
        self.simulator.set_target_realtime_rate(rate)

    # ---- state ---------------------------------------------------------------

    @property
    def context(self) -> Context:
        """The root context of the diagram."""
        return self.simulator.get_mutable_context()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.simulator.get_context().get_time()

    @property
    def atlas_state(self) -> AtlasState:
        """The latest joint and sensor state."""
        return self._output("atlas_state")

    @property
    def atlas_sim_interface_state(self) -> AtlasSimInterfaceState:
        """The latest state of the behaviours."""
        return self._output("atlas_sim_interface_state")

    @property
    def imu(self) -> Imu:
        """The latest IMU measurement."""
        return self._output("imu")

    @property
    def current_behavior(self) -> Behavior:
        """The active behaviour."""
        return self._output("controller_state").supervisor.current

    @property
    def has_fallen(self) -> bool:
        """Whether the robot fell at any time."""
        return any(event.kind == "fall" for event in self.events)

    @property
    def pelvis_pose(self) -> RigidTransform:
        """Pose of the pelvis in the world."""
        pelvis = self.plant.GetBodyByName(self.robot.file.pelvis)
        return self.plant.EvalBodyPoseInWorld(self._plant_context(), pelvis)

    @property
    def tick_seconds(self) -> list[float]:
        """Wall-clock times of the controller's ticks [s]."""
        return self._controller.tick_seconds

    def summary(self) -> dict[str, Any]:
        """What happened so far, as plain numbers and text ready for JSON."""
        return make_summary(self, self._wall_time, self._output("extremes"))

    # ---- inside --------------------------------------------------------------

    def _plant_context(self) -> Context:
        return self.plant.GetMyMutableContextFromRoot(self.context)

    def _output(self, name: str) -> Any:
        return self.diagram.GetOutputPort(name).Eval(self.context)

    def _exert_pushes(self) -> None:
        alive = [push for push in self._pushes if push.end > self.time + 1e-9]
        if not alive and not self._pushes:
            return
        self._pushes = alive
        forces = []
        for push in alive:
            force = ExternallyAppliedSpatialForce()
            force.body_index = self.plant.GetBodyByName(push.body).index()
            force.F_Bq_W = SpatialForce(np.zeros(3), push.force_W)
            forces.append(force)
        self.diagram.GetInputPort("applied_spatial_force").FixValue(
            self.context, forces
        )

    def _collect_events(self) -> None:
        """Notes what was sent, refused and done since the last look, in time order."""
        fresh: list[Event] = []
        sent = self._output("sent")
        for entry in self._scheduler.programme[self._seen_sent : sent]:
            fresh.append(Event(entry.time, "command", entry.text))
        self._seen_sent = sent
        force = self._output("commands")
        for refusal in force.refusals[
            len(force.refusals) - (force.refused - self._seen_refusals) :
        ]:
            fresh.append(Event(refusal.time, "refusal", refusal.text))
        self._seen_refusals = force.refused
        supervisor = self._output("controller_state").supervisor
        count = supervisor.event_count - self._seen_events
        if count:
            fresh.extend(supervisor.events[-count:])
        self._seen_events = supervisor.event_count
        for event in sorted(fresh, key=lambda event: event.time):
            self._note(event)

    def _note(self, event: Event) -> None:
        self.events.append(replace(event, time=round(event.time, 6)))
        if event.kind == "footstep":
            self.footsteps.append(event.data)
        if self._on_event is not None:
            self._on_event(event)


class SimulationError(AtlasError, RuntimeError):
    """The physics could not be solved any further."""
