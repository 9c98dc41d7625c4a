"""``AtlasSimulation``: builds one robot's diagram, publishes, advances, reads, resets.

``beginning`` puts robot and world where a run begins, ``run_log`` keeps its events.
"""

from __future__ import annotations

import math
import threading
import time
from array import array
from collections.abc import Callable, Iterable, MutableSequence, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.tree import FrameIndex
from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    InitializeParams,
    Simulator,
)
from pydrake.systems.framework import Context

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.config import as_float, checked
from atlas_drake.diagrams.atlas_station import reset_station
from atlas_drake.diagrams.control_mode_switch import Extend, make_control_mode_switch
from atlas_drake.diagrams.controller_socket import CONTROLLER, ControllerSource
from atlas_drake.errors import (
    AtlasError,
    InvalidMessageError,
    ScenarioError,
    WaitTimeoutError,
    did_you_mean,
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
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.event import Event, LoggedCommand, RunEvent
from atlas_drake.records import Schema, TickRecord
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.differences import built_in_difference
from atlas_drake.scenario.scenario import Seed, starting_behavior
from atlas_drake.shipped import BEHAVIORS, registered
from atlas_drake.simulation.beginning import (
    Variation,
    begin,
    draw_variation,
    moved,
    place,
    put_back,
)
from atlas_drake.simulation.pace import Pace, steady_ticks
from atlas_drake.simulation.run_log import Beginning, Done, RunLog, Snapshot
from atlas_drake.simulation.summary import make_summary
from atlas_drake.simulation.tutorial import scheduled
from atlas_drake.systems.record_reader import RecordListener
from atlas_drake.worlds.world import WorldMaker, listed

CHUNK = 0.02
"""Simulated time between two calls of the hooks [s]."""
Hook = Callable[["AtlasSimulation"], object]
"""Called between two chunks of an advance."""


class SimulationError(AtlasError, RuntimeError):
    """The physics could not be solved any further."""


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
        scenario: The scenario of the present run.
        tick_seconds: Wall-clock times of the controller's ticks [s]; empty if it gives
            none.
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
        self._own_behaviors = registered(behaviors)
        scenario = (scenario or Scenario()).resolved(self._own_behaviors)
        self.robot = load_robot(scenario.model)
        self.behaviors = BehaviorCatalog((*BEHAVIORS, *self._own_behaviors))
        self._schedule = scheduled(scenario, self.robot, self.behaviors)
        world = listed(world)
        self.diagram = make_control_mode_switch(
            self.robot,
            scenario,
            self._schedule,
            controller=controller,
            behaviors=self._own_behaviors,
            world=world,
            extend=extend,
        )
        self.station: Any = self.diagram.GetSubsystemByName("station")
        self.plant: Any = self.station.GetSubsystemByName("plant")
        self.simulator = Simulator(self.diagram)
        ApplySimulatorConfig(scenario.simulator, self.simulator)
        self._pace = Pace(self.simulator)
        self.tick_seconds: MutableSequence[float] = array("d")
        for name in (CONTROLLER, "tick_recorder"):
            system = self.station.GetSubsystemByName(name)
            if hasattr(system, "tick_seconds"):
                system.tick_seconds = self.tick_seconds
        # Where only a model of the world can be in the robot's way.
        self._trial: Context | None = None
        if world or scenario.all_models():
            self._trial = self.diagram.CreateDefaultContext()
        self.hooks: list[Hook] = []
        self.listeners = list(listeners)
        self._thread: int | None = None  # Of the advance that goes on.
        self._begin(scenario)

    def _begin(self, scenario: Scenario) -> None:
        """Begins a run at time 0, with what is drawn from the scenario's seed."""
        source, of_source = self.part("push_source")
        pushes = source.schedule(scenario.pushes)
        variation = draw_variation(scenario, self.robot)
        self._check_place(scenario, variation, scenario.start)
        self.scenario, self._variation = scenario, variation
        begin(self, scenario, variation)
        source.begin(of_source, pushes)
        self.simulator.Initialize()
        self._pace.forget_all()
        del self.tick_seconds[:]
        self._log = RunLog(scenario, self._schedule)
        self._wall_time = 0.0
        self._call_listeners("begin", self)

    def _check_place(
        self, scenario: Scenario, variation: Variation, start: Start
    ) -> None:
        """Raises WorldError if the robot cannot begin there, before it is put there."""
        if self._trial is not None:
            place(self, self._trial, scenario, variation, start)

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

    def publish(self, message: AtlasCommand | AtlasSimInterfaceCommand | None) -> None:
        """Sends a copy of a command, which takes effect at the next control update.

        Messages of one instant are taken in the order in which they are sent, and a
        message that is sent again counts again.

        A contradiction to the commands in force then, such as a stamp before the last
        one, is not raised but reported: by ``error_code``, and as an event.

        Args:
            message: The command; None, as from ``walk_at`` to a robot that already does
                what is asked for, sends nothing.

        Raises:
            InvalidMessageError: If the message cannot be applied. The robot then
                reports the error's code, and what was in force stays in force.
            TypeError: If ``message`` is neither a command nor None.
            RuntimeError: If another thread advances the simulation.
        """
        self._check_thread()
        if message is None:
            return
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
        interface, context = self.part("command_interface")
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
        source, context = self.part("push_source")
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
                        self._pace.forget_lost_time()
                        self._solve(min(end, self.time + CHUNK))
                        self._look()
        finally:
            self._thread = outer
            self._wall_time += time.perf_counter() - begin

    def _solve(self, t: float) -> None:
        """Lets Drake simulate until a time [s]."""
        try:
            self.simulator.AdvanceTo(t)
        except RuntimeError as error:
            raise SimulationError(
                f"the simulation stopped at {self.time:.3f} s: {error}"
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
        self._pace.set_rate(rate)

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
        asked = self.scenario.initial_behavior if behavior is None else behavior
        active = starting_behavior(asked, "behavior", self.behaviors)
        given = self.scenario.start if pose is None else pose
        start: Start = checked(Start, given, "pose")
        start.check_behavior(active)
        if start.on_gantry and not self.station.HasSubsystemNamed("gantry"):
            problem = "needs a scenario that began on the gantry"
            raise ScenarioError("start.on_gantry", True, problem)
        where = None if pose is None else self.scenario.start_pose(start)
        if seed is not None:
            new = replace(self.scenario, seed=checked(Seed, seed, "seed"))
            if where is not None:
                drawn = moved(draw_variation(new, self.robot), where)
                self._check_place(new, drawn, start)
            self._begin_anew(new)
            if behavior is None and pose is None:
                return
        variation = moved(self._variation, where)
        self._check_place(self.scenario, variation, start)
        # Collect events that precede the reset.
        self._look()
        for system in self.diagram.GetSystems():
            if isinstance(system, RecordListener):
                # A controller that failed gives no record, and is reset all the same.
                with suppress(Exception):
                    system.flush(system.GetMyContextFromRoot(self.context))
        put_back(self, variation, start)
        reset_station(self.station, self.context, active)
        self._log.begin(self._beginning(active, None if pose is None else start))
        text = f"reset, {active.name} begins"
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
        asked = scenario.resolved(self._own_behaviors)
        field = built_in_difference(self.scenario, asked)
        if field is not None:
            raise ScenarioError(field, None, "is changed, and needs a new simulation")
        self._begin_anew(asked)

    def _begin_anew(self, scenario: Scenario) -> None:
        """Begins another run, of a scenario that the diagram can take up."""
        self._begin(scenario)

    def snapshot(self) -> Snapshot:
        """Stores the present, for ``restore``.

        Takes 2 to 4 ms and 2.5 MB. What a system of your own keeps outside Drake's
        Context is not part of it.
        """
        self._look()
        return Snapshot(
            self.context.Clone(),
            self.scenario,
            self._variation,
            self._log.copy(),
            self._wall_time,
        )

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
        try:
            self.diagram.ValidateContext(snapshot.context)
        except (RuntimeError, ValueError):
            raise ValueError("the snapshot is that of another simulation") from None
        self.context.SetTimeStateAndParametersFrom(snapshot.context)
        self.scenario, self._variation = snapshot.scenario, snapshot.variation
        # Without the events of an initialization; updates that are due now still come.
        self.simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        self._pace.forget_all()
        self._log = snapshot.log.copy()
        self._wall_time = snapshot.wall_time
        self.diagram.ForcedPublish(self.context)

    def drop_schedule(self) -> None:
        """Sends nothing more of the scenario's schedule and messages."""
        self._check_thread()
        self._look()
        if self._schedule:
            scheduler: Any = self.diagram.GetSubsystemByName("scheduler")
            scheduler.drop_rest(scheduler.GetMyMutableContextFromRoot(self.context))
        self._tell(self._log.drop_schedule(self.time))

    def release(self) -> None:
        """Lets a robot on the gantry down to the ground, and then go.

        Raises:
            ScenarioError: If the scenario has no gantry.
        """
        if not self.station.HasSubsystemNamed("gantry"):
            problem = "there is no gantry to release"
            raise ScenarioError("start.on_gantry", False, problem)
        gantry, context = self.part("gantry")
        gantry.release(context)
        self._look()

    # ---- state ---------------------------------------------------------------

    @property
    def context(self) -> Context:
        """The diagram's root context."""
        return self.simulator.get_mutable_context()

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
        """Pose of a body or frame in the world.

        Args:
            name: Of the robot, such as ``l_hand`` or ``r_sole``, or else of another
                model, such as ``crate``.

        Raises:
            ValueError: If there is no frame of that name, or there are several.
        """
        plant, context = self.part("plant")
        own = self.robot.instance(plant)
        if plant.HasFrameNamed(name, own):
            return plant.GetFrameByName(name, own).CalcPoseInWorld(context)
        frames = [plant.get_frame(FrameIndex(k)) for k in range(plant.num_frames())]
        named = [frame for frame in frames if frame.name() == name]
        if len(named) > 1:
            models = [plant.GetModelInstanceName(f.model_instance()) for f in named]
            raise ValueError(f"there are frames {name!r} of {', '.join(models)}")
        if not named:
            hint = did_you_mean(name, {frame.name() for frame in frames})
            raise ValueError(f"there is no frame {name!r}.{hint}")
        return named[0].CalcPoseInWorld(context)

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
        try:
            port = self.diagram.GetOutputPort(name)
        except (RuntimeError, TypeError) as error:
            raise ValueError(f"there is no output port {name!r}: {error}") from error
        return port.Eval(self.context)

    def part(self, name: str) -> tuple[Any, Context]:
        """Returns a system of the station, and its context.

        Args:
            name: Of the system, such as ``plant``.
        """
        system: Any = self.station.GetSubsystemByName(name)
        return system, system.GetMyMutableContextFromRoot(self.context)

    def summary(self) -> dict[str, Any]:
        """Summarizes the run as plain numbers and text, ready for JSON."""
        return make_summary(self, self._wall_time)

    # ---- events --------------------------------------------------------------

    def _look(self) -> None:
        """Collects events."""
        self._tell(self._log.look(self))

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
