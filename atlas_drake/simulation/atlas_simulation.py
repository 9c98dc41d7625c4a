"""``AtlasSimulation``: builds one robot's diagram, publishes, advances, reads, resets.

``run_diagram`` builds and holds the diagram of a run, ``run_log`` its events.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterable, MutableSequence, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.config import as_float, checked
from atlas_drake.diagrams.control_mode_switch import Extend
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.errors import (
    InvalidMessageError,
    ScenarioError,
    WaitTimeoutError,
    shown,
)
from atlas_drake.messages import (
    Accepted,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Behavior,
    Imu,
    Refusal,
    accept,
)
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.event import Event, LoggedCommand, RunEvent
from atlas_drake.records import Schema, TickRecord
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.differences import built_in_difference
from atlas_drake.scenario.scenario import Seed
from atlas_drake.simulation.pace import steady_ticks
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.run_log import Beginning, Done, RunLog, Snapshot
from atlas_drake.simulation.start import start_of_reset
from atlas_drake.simulation.summary import make_summary
from atlas_drake.worlds.world import WorldMaker

CHUNK = 0.02
"""Simulated time between two calls of the hooks [s]."""
Hook = Callable[["AtlasSimulation"], object]
"""Called between two chunks of an advance."""


class AtlasSimulation:
    """A simulated Atlas with joint controllers and behaviors.

    It is for one thread at a time, as Drake's Context is. Other threads hand over what
    they want to one of the ``hooks``, by a ``queue.Queue`` for instance.

    Attributes:
        robot: Description of the robot: joint names, limits, masses.
        behaviors: Catalog of the behaviors that can be requested.
        diagram: The ``control_mode_switch``, with all systems.
        station: The ``AtlasStation`` in the diagram.
        plant: The ``MultibodyPlant`` of the station.
        simulator: Drake's simulator of the diagram.
        hooks: Callables (sim) -> None, called in their order by the thread that
            advances, every 20 ms of simulated time. They may publish, push, wait,
            reset and restore; when one goes back in time, the advance still lasts as
            long as was asked. This is how clients such as the cockpit join.
        listeners: Objects with any of ``begin(sim)``, called as a run begins,
            ``event(event)``, with each event as it is noticed, and ``close()``, with
            that of the simulation.

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
        controller: ControllerSource | None = None,
        behaviors: Iterable[BehaviorEntry] = (),
        world: Iterable[WorldMaker] = (),
        extend: Extend | Iterable[Extend] = (),
        listeners: Iterable[object] = (),
    ):
        """Builds the diagram and puts the robot on its feet.

        Args:
            scenario: The scenario to simulate; it is copied. None is a robot that
                stands, without a schedule.
            controller: Replaces the shipped controller: a System, or a callable
                (robot, scenario) -> System. See
                ``atlas_drake.diagrams.controller_socket``.
            behaviors: Behaviors added to those of the shipped controller, see
                ``atlas_drake.behaviors.entry.BehaviorEntry``.
            world: Callables (plant) -> None that add models beside the robot before the
                plant is finalized: a table, a ball.
            extend: Called with (builder, station) before the diagram is built, to add
                systems of your own; one callable or a list. ``output`` reads the ports
                that it exports.
            listeners: The first ``listeners``, in their order.

        Raises:
            TypeError: If an argument is of the wrong type; it names the argument.
            ScenarioError: If the scenario has a value that cannot be used.
            RobotDescriptionError: If the robot's files cannot be used.
            ControllerError: If the controller does not fit the station.
            WorldError: If the world cannot be added, or the robot would begin inside
                a model of it.
            BehaviorError: If a behavior cannot be registered.
        """
        check_types(scenario=(scenario, Scenario), listeners=(listeners, Iterable))
        scenario = scenario or Scenario()
        self._run = RunDiagram(scenario, controller, behaviors, world, extend)
        self.behaviors, self.listeners = self._run.catalog, list(listeners)
        self.robot, self.simulator = self._run.robot, self._run.simulator
        self.diagram, self.station = self._run.diagram, self._run.station
        self.plant = self._run.plant
        self.hooks: list[Hook] = []
        self._thread: int | None = None  # Of the advance that goes on.
        self._note_begin()

    def _note_begin(self) -> None:
        """Starts the records of a run that begins."""
        self._log = RunLog(self._run)
        self._wall_time = 0.0
        self._call_listeners("begin", self)

    def close(self) -> None:
        """Tells the listeners, such as a log; the run may continue.

        Raises:
            LogError: If a log cannot be completed, now or earlier in the run, whose
                ``events`` then hold a warning.
        """
        # An error that ended the run occurs again in this look.
        with suppress(Exception):
            self._look()
        self._call_listeners("close")

    def __enter__(self) -> AtlasSimulation:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    # ---- commands ------------------------------------------------------------

    def publish(self, message: AtlasCommand | AtlasSimInterfaceCommand) -> None:
        """Sends a copy of a command, which takes effect at the next control update.

        Messages of one instant are taken in the order in which they are sent, and a
        message that is sent again counts again.

        A contradiction to the commands in force then, such as a stamp before the last
        one, is not raised but reported: by ``error_code``, and as an event.

        Args:
            message: The command.

        Raises:
            InvalidMessageError: If the message cannot be applied. The robot then
                reports the error's code, and what was in force stays in force.
            TypeError: If ``message`` is not a command.
            RuntimeError: If another thread advances the simulation.
        """
        self._check_thread()
        if not isinstance(message, (AtlasCommand, AtlasSimInterfaceCommand)):
            raise TypeError(
                "publish takes an AtlasCommand or an AtlasSimInterfaceCommand, not "
                f"{type(message).__name__}"
            )
        outcome = accept(message, self.robot, self.behaviors)
        refusal = self._receive(outcome)
        if refusal is not None:
            self._look()
            raise refusal.error
        self._log.published(self.output("commands").received)

    def _receive(self, outcome: Accepted | Refusal) -> Refusal | None:
        """Hands over what the door said of a message; returns why it is refused."""
        interface, context = self._run.part("command_interface")
        return interface.receive(context, outcome)

    def apply_push(
        self, body: str, force_W: Sequence[float] | np.ndarray, duration: float
    ) -> None:
        """Pushes a body at its origin from now on.

        Args:
            body: Name of a link, such as ``l_hand``; ``trunk`` is that of the chest on
                every robot.
            force_W: Force in W [N], shape (3,).
            duration: Duration of the push [s], positive.

        Raises:
            InvalidMessageError: If there is no such body or a value is not a number.
            RuntimeError: If another thread advances the simulation.
        """
        self._check_thread()
        source, context = self._run.part("push_source")
        source.push(context, body, force_W, duration)
        self._look()

    # ---- time ----------------------------------------------------------------

    def advance(self, seconds: float) -> None:
        """Simulates for some time; errors are those of ``advance_to``.

        Args:
            seconds: Simulated time [s], not negative.
        """
        self.advance_to(self.time + check_number(seconds, "seconds", 0.0))

    def advance_to(self, t: float) -> None:
        """Simulates until a time.

        Args:
            t: Simulated time [s].

        Raises:
            InvalidMessageError: If ``t`` is in the past, or no time.
            SimulationError: If the physics could not be solved; what was recorded
                until then is kept.
            RuntimeError: If another thread advances the simulation.
        """
        self._check_thread()
        end = as_float(t)
        if end is None or not math.isfinite(end) or end < self.time - 1e-9:
            raise InvalidMessageError(
                "t",
                t,
                f"cannot advance to {shown(t)} s: it must be a time not before now, "
                f"{self.time:.3f} s",
            )
        begin, outer = time.perf_counter(), self._thread
        self._thread = threading.get_ident()
        try:
            with steady_ticks():
                while self.time < end - 1e-9:
                    end += self._call_hooks()
                    if self.time < end - 1e-9:
                        self._run.advance_to(min(end, self.time + CHUNK))
                        self._look()
        finally:
            self._thread = outer
            self._wall_time += time.perf_counter() - begin

    def _check_thread(self) -> None:
        """Refuses what a Drake Context cannot bear: a second thread in an advance."""
        if self._thread not in (None, threading.get_ident()):
            raise RuntimeError(
                "another thread advances this simulation: hand over what you want to "
                "one of its hooks, which that thread calls"
            )

    def _call_hooks(self) -> float:
        """Calls the hooks; returns how far they went back in time [s], <= 0."""
        before = self.time
        for hook in tuple(self.hooks):
            hook(self)
        return min(self.time - before, 0.0)

    def wait_until(
        self,
        condition: Callable[[AtlasSimulation], bool],
        timeout: float = 10.0,
        *,
        what: str = "the condition",
        period: float = CHUNK,
    ) -> float:
        """Simulates until a condition holds.

        Example:
            >>> sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND)

        Args:
            condition: Called with the simulation, now and after every ``period``.
            timeout: Longest wait [s], in simulated time.
            what: The condition in words, for the error.
            period: Simulated time between two calls [s].

        Returns:
            How long it took [s], in simulated time.

        Raises:
            WaitTimeoutError: If the condition did not hold in that time.
            InvalidMessageError: If ``timeout`` or ``period`` cannot be used.
            SimulationError: If the physics could not be solved.
        """
        begin = self.time
        end = begin + check_number(timeout, "timeout", 0.0)
        check_number(period, "period", 1e-9)
        while not condition(self):
            if self.time >= end - 1e-9:
                raise WaitTimeoutError(
                    f"{what} did not hold within {timeout:g} s of simulated time, from "
                    f"{begin:.3f} s to {self.time:.3f} s"
                )
            self.advance_to(min(self.time + period, end))
        return self.time - begin

    @property
    def realtime_rate(self) -> float:
        """Multiple of real time that simulated time keeps to; 0 is unlimited."""
        return self.simulator.get_target_realtime_rate()

    def set_realtime_rate(self, rate: float) -> None:
        """Keeps simulated time at a multiple of real time.

        Only time during advances counts: after a pause between two of them, and where
        the computer was too slow, the simulation does not hurry to catch up.

        Args:
            rate: The multiple; 0 is as fast as can be.

        Raises:
            InvalidMessageError: If ``rate`` is negative or not a number.
        """
        rate = check_number(rate, "rate", 0.0)
        self._run.pace.set_rate(rate)

    # ---- start ---------------------------------------------------------------

    def reset(
        self,
        behavior: Behavior | int | str | None = None,
        pose: Start | None = None,
        *,
        seed: int | None = None,
    ) -> None:
        """Puts the robot back on its feet, with nothing in force but ``behavior``.

        Joint controllers, behaviors and the models of the world return to their initial
        states, and pushes end. Time continues, and so does the rest of a schedule.

        With a ``seed`` a new run begins: time, schedule, events and summary start from
        zero, and whatever the scenario jitters is drawn anew. Such a run equals that of
        a new simulation with this seed bit for bit, but begins much faster.

        After an error the present run goes on as it was.

        Args:
            behavior: STAND, STAND_PREP, USER or FREEZE; None is the scenario's.
            pose: Where to; None is where the run began. A gantry holds the robot if
                the scenario has one and ``pose.on_gantry`` says so.
            seed: Seed of the new run; None continues the present run.

        Raises:
            InvalidMessageError: If the robot cannot begin with that behavior.
            ScenarioError: If it cannot begin in that pose or with that seed.
            WorldError: If the robot would begin inside a model of the world.
        """
        # All is checked before anything changes.
        begin, start = start_of_reset(self.scenario, self.behaviors, behavior, pose)
        where = None if pose is None else self.scenario.start_pose(start)
        if seed is not None:
            new = replace(self.scenario, seed=checked(Seed, seed, "seed"))
            if where is not None:
                self._run.check_reset(new, start, where)
            self._begin_anew(new)
            if behavior is None and pose is None:
                return
        # Collect events that precede the reset.
        self._look()
        self._run.reset(begin, start, where)
        self._log.begin(self._beginning(begin, None if pose is None else start))
        text = f"reset, {begin.name} begins"
        self._tell(self._log.note(RunEvent(self.time, "reset", text)))
        self.simulator.Initialize()
        self._look()

    def _beginning(self, behavior: Behavior, start: Start | None) -> Beginning:
        """Returns how a reset begins; a ``start`` of its own is exact."""
        scenario = replace(self.scenario, initial_behavior=behavior.name)
        if start is not None:
            jitter = replace(scenario.jitter, position=0.0, orientation=0.0)
            scenario = replace(scenario, start=start, jitter=jitter)
        return Beginning(self.time, scenario)

    def restart(self, scenario: Scenario) -> None:
        """Begins a new run, as ``reset(seed=...)`` does, of a scenario that differs.

        Such a run equals that of a new simulation bit for bit. The scenario may differ
        in what matters to a run alone, ``scenario.differences.OF_A_RUN``: seed, jitter,
        friction, pushes, where the robot begins.

        Args:
            scenario: Of the new run; it is copied.

        Raises:
            ScenarioError: If a field cannot be used or needs a new simulation.
            WorldError: If the robot would begin inside a model of the world; the
                present run is then unchanged.
        """
        asked = scenario.resolved(self._run.own_behaviors)
        field = built_in_difference(self.scenario, asked)
        if field is not None:
            raise ScenarioError(field, None, "is changed, and needs a new simulation")
        self._begin_anew(asked)

    def _begin_anew(self, scenario: Scenario) -> None:
        """Begins a run of a scenario that the diagram can take up."""
        self._run.begin(scenario)
        self._note_begin()

    def snapshot(self) -> Snapshot:
        """Stores the present, for ``restore``.

        Takes 2 to 4 ms and 2.5 MB. What a system of your own keeps outside Drake's
        Context is not part of it.
        """
        self._look()
        context, variation = self._run.context.Clone(), self._run.variation
        log = self._log.copy()
        return Snapshot(context, self.scenario, variation, log, self._wall_time)

    def restore(self, snapshot: Snapshot) -> None:
        """Goes back (or ahead) to a stored snapshot; a 3D view shows it at once.

        The run goes on from there with the same bits as it did then: robot and world,
        joint controllers, behaviors, shares of the user, messages and pushes that were
        pending, the rest of a schedule, noise and events. ``tick_seconds`` keeps the
        times of all ticks, and ``listeners`` get the events that follow once more.

        Args:
            snapshot: Of this simulation; also of an earlier run. It can be restored any
                number of times.

        Raises:
            TypeError: If ``snapshot`` is not a ``Snapshot``.
            ValueError: If it is that of another simulation.
        """
        if not isinstance(snapshot, Snapshot):
            raise TypeError(
                f"restore takes what snapshot() returned, not {type(snapshot).__name__}"
            )
        self._run.restore(snapshot.context, snapshot.scenario, snapshot.variation)
        self._log = snapshot.log.copy()
        self._wall_time = snapshot.wall_time
        self.diagram.ForcedPublish(self.context)

    def drop_schedule(self) -> None:
        """Sends nothing more of the scenario's schedule and messages."""
        self._check_thread()
        self._look()
        self._run.drop_schedule()
        self._tell(self._log.drop_schedule())

    def release(self) -> None:
        """Lets a robot on the gantry down to the ground, and then go.

        Raises:
            ScenarioError: If the scenario has no gantry.
        """
        if not self.station.HasSubsystemNamed("gantry"):
            problem = "there is no gantry to release"
            raise ScenarioError("start.on_gantry", False, problem)
        gantry, context = self._run.part("gantry")
        gantry.release(context)
        self._look()

    # ---- state ---------------------------------------------------------------

    @property
    def scenario(self) -> Scenario:
        """The scenario of the present run."""
        return self._run.scenario

    @property
    def context(self) -> Context:
        """The diagram's root context."""
        return self._run.context

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.simulator.get_context().get_time()

    @property
    def atlas_state(self) -> AtlasState:
        """The latest joint and sensor state."""
        return self.output("atlas_state")

    @property
    def atlas_sim_interface_state(self) -> AtlasSimInterfaceState:
        """The latest state of the behaviors."""
        return self.output("atlas_sim_interface_state")

    @property
    def imu(self) -> Imu:
        """The latest IMU measurement."""
        return self.output("imu")

    @property
    def current_behavior(self) -> Behavior:
        """The active behavior."""
        return self.output("controller_status").current_behavior

    @property
    def has_fallen(self) -> bool:
        """True if the robot fell since the start or the last reset."""
        return self._log.fallen()

    @property
    def schema(self) -> Schema:
        """The schema of the records: names, units and labels of their numbers."""
        schema: Schema = self.station.GetSubsystemByName("tick_recorder").schema
        return schema

    @property
    def record(self) -> TickRecord:
        """The record of the latest control tick; before the first one, of the start."""
        return self.output("record")

    @property
    def events(self) -> list[Event]:
        """All events so far."""
        return self._log.events

    @property
    def commands(self) -> list[LoggedCommand]:
        """The accepted commands of the run, in order: also those of a schedule."""
        self._look()
        return self._log.commands

    @property
    def beginning(self) -> Beginning:
        """How the robot began, at the start of the run or at its last reset."""
        return self._log.beginning

    def done(self) -> list[Done]:
        """Returns the accepted messages and the pushes since the last reset, in order.

        ``simulation.done`` makes a scenario of them.

        Raises:
            ScenarioError: If they are too many to be kept.
        """
        self._look()
        return self._log.done()

    @property
    def footsteps(self) -> list[dict[str, Any]]:
        """Every footstep taken: what was commanded, and where the foot landed."""
        return self._log.footsteps

    @property
    def pelvis_pose(self) -> RigidTransform:
        """Pose of the pelvis in the world."""
        return self.frame_pose(self.robot.file.pelvis)

    def frame_pose(self, name: str) -> RigidTransform:
        """Pose of a body or frame of the robot in the world.

        Args:
            name: In the robot's URDF, such as ``l_hand`` or ``r_sole``.

        Raises:
            ValueError: If the robot has neither a body nor a frame of that name.
        """
        own = self.robot.instance(self.plant)
        try:
            frame = self.plant.GetFrameByName(name, own)
        except (RuntimeError, TypeError) as error:
            raise ValueError(f"there is no frame {name!r}: {error}") from error
        return frame.CalcPoseInWorld(self._run.plant_context)

    @property
    def tick_seconds(self) -> MutableSequence[float]:
        """Wall-clock times of the controller's ticks [s]; empty if it gives none."""
        return self._run.tick_seconds

    def output(self, name: str) -> Any:
        """Reads an output port of the station.

        Args:
            name: Of the port, such as ``effort``: those of
                ``atlas_drake.diagrams.atlas_station.make_atlas_station``, and ``sent``.

        Returns:
            A message or another frozen value, or an array, as the port has it.

        Raises:
            ValueError: If there is no such port.
        """
        return self._run.output(name)

    def summary(self) -> dict[str, Any]:
        """Summarizes the run as plain numbers and text, ready for JSON."""
        return make_summary(self, self._wall_time)

    # ---- events --------------------------------------------------------------

    def _look(self) -> None:
        """Collects events."""
        self._tell(self._log.look())

    def _tell(self, events: Iterable[Event]) -> None:
        """Hands events on, once all of them are kept."""
        events = tuple(events)
        for listener in tuple(self.listeners):
            for event in events:
                _call(listener, "event", event)

    def _call_listeners(self, name: str, *arguments: object) -> None:
        """Calls a method of each listener that has it."""
        for listener in tuple(self.listeners):
            _call(listener, name, *arguments)


def _call(listener: object, name: str, *arguments: object) -> None:
    """Calls a method of a listener that has it."""
    method = getattr(listener, name, None)
    if method is not None:
        method(*arguments)


def check_types(**arguments: tuple[object, Any]) -> None:
    """Checks types of arguments.

    Args:
        arguments: Value and type of each, by its name; None is of any type.

    Raises:
        TypeError: If a value is not of its type; it names the argument.
    """
    for name, (value, kind) in arguments.items():
        if value is not None and not isinstance(value, kind):
            type_name = getattr(kind, "__name__", str(kind))
            raise TypeError(f"{name} must be of type {type_name}, is {shown(value)}")
