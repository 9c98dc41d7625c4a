"""``AtlasSimulation``: builds one robot's diagram, publishes, advances, reads, resets.

The diagram and its runs are in ``run_diagram``, events in ``run_log``, logs, videos and
listeners in ``sinks``.
"""

from __future__ import annotations

import math
import time
from array import array
from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import registered
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.checked import checked
from atlas_drake.diagrams.control_mode_switch import Extend
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.errors import (
    InvalidMessageError,
    ScenarioError,
    WaitTimeoutError,
    shown,
)
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Behavior,
    Imu,
    check_command,
)
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.event import Event
from atlas_drake.numeric import as_float
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.models import world_of
from atlas_drake.scenario.scenario import check_seed, starting_behavior
from atlas_drake.scenario.world import (
    WorldMaker,
    listed,
)
from atlas_drake.simulation.arguments import check_arguments
from atlas_drake.simulation.fair_lock import FairLock
from atlas_drake.simulation.pace import Pace
from atlas_drake.simulation.programme import scheduled_programme
from atlas_drake.simulation.restart import built_in_difference
from atlas_drake.simulation.run_diagram import RunDiagram
from atlas_drake.simulation.run_log import RunLog
from atlas_drake.simulation.sinks import FileSink, Listener, Sink
from atlas_drake.simulation.steady import steady_ticks
from atlas_drake.simulation.summary import make_summary
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video

CHUNK = 0.02
"""Simulated time between looks at events and Ctrl-C [s]."""


class AtlasSimulation:
    """A simulated Atlas with joint controllers and behaviors.

    Attributes:
        scenario: The scenario that is simulated.
        robot: Description of the robot: joint names, limits, masses.
        behaviors: Catalog of the behaviors that can be requested.
        diagram: The ``control_mode_switch``, with all systems.
        station: The ``AtlasStation`` in the diagram.
        plant: The ``MultibodyPlant`` of the station.
        simulator: Drake's simulator of the diagram.
        meshcat: Meshcat of the 3D view, None without a view.

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
        world: Sequence[WorldMaker] = (),
        extend: Extend | None = None,
        view: bool | Meshcat | None = None,
        overlays: Overlays | None = None,
        recorded: bool = False,
        video: Video | None = None,
        on_event: Callable[[Event], None] | None = None,
        log: str | Path | None = None,
    ):
        """Builds the diagram and puts the robot on its feet.

        Args:
            scenario: The scenario to simulate; it is copied. None is a robot that
                stands, without a programme.
            controller: Replaces the shipped controller: a System, or a callable
                (robot, config: StationConfig) -> System. See
                ``atlas_drake.diagrams.controller_socket`` for its ports.
            behaviors: Behaviors added to those of the shipped controller. Commands
                request them by name or number, see
                ``atlas_drake.behaviors.entry.BehaviorEntry``.
            world: Callables (plant) -> None that add models beside the robot before the
                plant is finalized: a table, a ball. They are called again for a video.
            extend: Called with (builder, station) before the diagram is built, to add
                systems of your own. ``output`` reads the ports that it exports.
            view: True opens a 3D view in the browser, prints its address, and shows
                the run in real time; ``atlas_drake.visualization.viewer`` has more
                choices. A Meshcat of yours is drawn in at full speed. None and
                False show nothing.
            overlays: Plans of the controller that are shown there and in the video.
            recorded: True if Meshcat is recording already; then every picture is kept
                for the recording. Otherwise pictures are left out while a viewer is too
                slow for them, and a recording that runs then is lost.
            video: Attaches a video of the run; None films nothing.
            on_event: Called with each event as it is noticed.
            log: Attaches a file that records the run, see ``atlas_drake.logs``: .mcap,
                .npz or .parquet.

        Raises:
            TypeError: If an argument is of the wrong type; it names the argument.
            ScenarioError: If the scenario has a value that cannot be used.
            RobotDescriptionError: If the robot's files cannot be used.
            LogError: If the log cannot be written.
            VideoError: If the video cannot be made.
            ControllerError: If the controller does not fit the station.
            WorldError: If the world cannot be added, or the robot would begin inside
                a model of it.
            BehaviorError: If a behavior cannot be registered.
        """
        check_arguments(
            scenario=scenario,
            view=view,
            overlays=overlays,
            video=video,
            on_event=on_event,
            log=log,
        )
        self._own_behaviors = registered(behaviors)
        self.scenario = (scenario or Scenario()).resolved(self._own_behaviors)
        self.robot = load_robot(self.scenario.model)
        self.behaviors = BehaviorCatalog((*SHIPPED_ENTRIES, *self._own_behaviors))
        self._asked_model = self.scenario.model
        # Absolute, so that it is valid in another working folder, too.
        self.scenario = replace(self.scenario, model=self.robot.model)
        self._programme = scheduled_programme(self.scenario, self.robot, self.behaviors)
        self._tick_seconds = array("d")
        self._lock = FairLock()
        world = (*world_of(self.scenario.all_models()), *listed(world))
        recorder = None
        if log is not None:
            # The modules for logs load only with a log.
            from atlas_drake.logs.recorder import start_recorder

            recorder = start_recorder(
                Path(log),
                self.scenario,
                self.robot,
                world,
                self._tick_seconds,
                self._own_behaviors,
            )
        try:
            if view is True:
                from atlas_drake.visualization.viewer import start_meshcat

                self.meshcat = start_meshcat()
            else:
                self.meshcat = view or None
            self._run = RunDiagram(
                self.robot,
                self.scenario,
                self._programme,
                self._tick_seconds,
                controller=controller,
                behaviors=self._own_behaviors,
                world=world,
                extend=extend,
                meshcat=self.meshcat,
                overlays=overlays,
                recorded=recorded,
                recorder=recorder,
                video=video,
                view=self.scenario.surroundings().view,
            )
        except BaseException:
            if recorder is not None:
                recorder.close()
            raise
        self.diagram, self.station = self._run.diagram, self._run.station
        self.plant, self.simulator = self._run.plant, self._run.simulator
        self._pace = Pace(self.simulator)
        self._sinks: list[Sink] = []
        if recorder is not None:
            self._sinks.append(FileSink(Path(str(log)), recorder))
        if video is not None:
            film: Any = self.diagram.GetSubsystemByName("video")
            self._sinks.append(FileSink(video.path, film))
        if on_event is not None:
            self._sinks.append(Listener(on_event))
        self._note_begin()
        if self.meshcat is not None:
            # The modules for Meshcat load only with a 3D view.
            from atlas_drake.visualization.scene import show_start

            show_start(self.meshcat, self.scenario)
        if view is True:
            from atlas_drake.visualization.viewer import await_viewer

            await_viewer(self.meshcat)
            if not self.realtime_rate:
                self.set_realtime_rate(1.0)

    def _note_begin(self) -> None:
        """Starts the records of a run that begins."""
        del self._tick_seconds[:]
        self._log = RunLog(self._sinks)
        self._error: str | None = None
        self._wall_time = 0.0
        self._pace.forget_all()

    # ---- sinks ---------------------------------------------------------------

    @property
    def sinks(self) -> tuple[Sink, ...]:
        """The attached sinks: log, video, ``on_event`` and those of ``attach``."""
        return tuple(self._sinks)

    def attach(self, sink: Sink) -> None:
        """Attaches a sink, which gets the events from now on.

        Args:
            sink: See ``atlas_drake.simulation.sinks.Sink``.
        """
        with self._lock:
            self._sinks.append(sink)

    def detach(self, sink: Sink) -> Any:
        """Collects the latest events, closes a sink and goes on without it.

        Args:
            sink: One of ``sinks``.

        Returns:
            The result of the sink's ``close``.

        Raises:
            ValueError: If the sink is not attached.
            AtlasError: If the sink cannot be completed, now or earlier in the run.
        """
        with self._lock:
            self._sinks.index(sink)
            reported = self._error
            try:
                self._look()
            except Exception:
                # An error that ended the run occurs again in this look.
                if reported is None or self._error != reported:
                    raise
            finally:  # Listeners and ports may raise anything.
                self._sinks.remove(sink)
                result = sink.close(self.context)
            return result

    def close(self) -> None:
        """Detaches all sinks, which completes their files; the run may continue.

        Raises:
            AtlasError: If a sink cannot be completed, now or earlier in the run, whose
                ``events`` then hold a warning; the others are completed.
        """
        with ExitStack() as stack:
            for sink in self._sinks:
                stack.callback(self.detach, sink)

    def __enter__(self) -> AtlasSimulation:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    # ---- commands ------------------------------------------------------------

    def publish(self, message: AtlasCommand | AtlasSimInterfaceCommand) -> None:
        """Sends a command; it takes effect at the next control update.

        The message is copied: the caller may go on changing and sending it. Messages
        of one instant are taken in the order in which they are sent, and a message
        that is sent again counts again.

        Any thread may call this. While another thread simulates, the message is checked
        here, and received before that thread simulates another 20 ms. A contradiction
        to the commands in force then, such as a stamp before the last one, is not
        raised but reported: by ``error_code``, and as an event.

        Args:
            message: The command.

        Raises:
            InvalidMessageError: If the message cannot be applied. The robot then
                reports the error's code, and what was in force stays in force.
            TypeError: If ``message`` is not a command.
        """
        if not isinstance(message, (AtlasCommand, AtlasSimInterfaceCommand)):
            raise TypeError(
                "publish takes an AtlasCommand or an AtlasSimInterfaceCommand, not "
                f"{type(message).__name__}"
            )
        snapshot = message.snapshot()
        if self._lock.leave(partial(self._run.receive, snapshot)):
            check_command(snapshot, self.robot.joint_names, self.behaviors)
            return
        with self._lock:
            refusal = self._run.receive(snapshot)
            if refusal is not None:
                self._look()
        if refusal is not None:
            # A new one: what is raised collects a traceback.
            raise InvalidMessageError(*refusal.error.args)

    def apply_push(
        self, body: str, force_W: Sequence[float] | np.ndarray, duration: float
    ) -> None:
        """Pushes a body at its origin from now on.

        Args:
            body: Name of a link, such as ``utorso``.
            force_W: Force in W [N], shape (3,).
            duration: How long [s], positive.

        Raises:
            InvalidMessageError: If there is no such body or a value is not a number.
        """
        with self._lock:
            self._run.push(body, force_W, duration)
            self._look()

    # ---- time ----------------------------------------------------------------

    def advance(self, seconds: float) -> None:
        """Simulates for a while.

        Args:
            seconds: How long [s].

        Raises:
            InvalidMessageError: If ``seconds`` is negative or not a number.
            SimulationError: As ``advance_to`` does.
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
        """
        end = as_float(t)
        if end is None or not math.isfinite(end) or end < self.time - 1e-9:
            raise InvalidMessageError(
                "t",
                t,
                f"cannot advance to {shown(t)} s: it must be a time not before now, "
                f"{self.time:.3f} s",
            )
        begin = time.perf_counter()
        try:
            with steady_ticks(), self._noted_error():
                while self.time < end - 1e-9:
                    with self._lock:
                        # Another thread may have had a turn meanwhile.
                        if self.time < end - 1e-9:
                            self._pace.forget_lost_time()
                            self._run.advance_to(min(end, self.time + CHUNK))
                            self._look()
        finally:
            self._wall_time += time.perf_counter() - begin

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
            timeout: How long to wait for it at most [s], in simulated time.
            what: The condition in words, for the error.
            period: Simulated time between two looks [s].

        Returns:
            How long it took [s], in simulated time.

        Raises:
            WaitTimeoutError: If the condition did not hold in that time.
            InvalidMessageError: If ``timeout`` or ``period`` cannot be used.
            SimulationError: If the physics could not be solved.
        """
        begin = self.time
        end = begin + check_number(timeout, "timeout", 0.0)
        check_number(period, "period", 0.0, strictly=True)
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
        checked = check_number(rate, "rate", 0.0)
        with self._lock:
            self._pace.set_rate(checked)

    # ---- start ---------------------------------------------------------------

    def reset(
        self,
        behavior: Behavior | int | str | None = None,
        pose: Start | None = None,
        *,
        seed: int | None = None,
    ) -> None:
        """Puts the robot back on its feet, with nothing in force but ``behavior``.

        Joint controllers and behaviors return to their initial states, pushes end, and
        the models of the world return to their initial poses. Time continues, and so
        does the rest of a programme.

        With a ``seed`` a new run begins: time, programme, events and summary start from
        zero, and whatever the scenario jitters is drawn anew. Such a run equals that of
        a new simulation with this seed bit for bit, but begins much faster.

        Args:
            seed: Seed of the new run; None continues the present run.
            behavior: STAND, STAND_PREP, USER or FREEZE; None is the scenario's.
            pose: Where to; None is where the run began. A harness holds the robot if
                the scenario has one and ``pose.harnessed`` says so.

        Raises:
            InvalidMessageError: If the robot cannot begin with that behavior.
            ScenarioError: If it cannot begin in that pose or with that seed, or while a
                log or a video is written, which hold one run.
            WorldError: If the robot would begin inside a model of the world.

        After an error the present run goes on as it was.
        """
        # All is checked before anything changes.
        asked = self.scenario.initial_behavior if behavior is None else behavior
        start = self.scenario.start if pose is None else pose
        begin = starting_behavior(asked, "behavior", self.behaviors)
        start = checked(Start, start, "pose")
        start.check_behavior(begin)
        if start.harnessed and not self.scenario.start.harnessed:
            raise ScenarioError(
                "start.harnessed", True, "needs a scenario that began in a harness"
            )
        where = None if pose is None else self.scenario.start_pose(pose)
        if seed is not None:
            new = replace(self.scenario, seed=check_seed(seed))
            if where is not None:
                self._run.check_reset(new, start, where)
            self._begin_anew(new)
            if behavior is None and pose is None:
                return
        with self._lock:
            # Collect events that precede the reset.
            self._look()
            self._run.reset(begin, start, where)
            self._log.note(Event(self.time, "reset", f"reset, {begin.name} begins"))
            self.simulator.Initialize()
            self._look(anew=True)

    def restart(self, scenario: Scenario) -> None:
        """Begins a new run, as ``reset(seed=...)`` does, of a scenario that differs.

        Such a run equals that of a new simulation bit for bit. The scenario may differ
        in what matters to a run alone, ``simulation.restart.OF_A_RUN``: seed, jitter,
        friction, pushes, where the robot begins.

        Args:
            scenario: Of the new run; it is copied.

        Raises:
            ScenarioError: If a field cannot be used or needs a new simulation, or while
                a log or a video is written, which hold one run.
            WorldError: If the robot would begin inside a model of the world; the
                present run is then unchanged.
        """
        asked = scenario.resolved(self._own_behaviors)
        if asked.model == self._asked_model:
            asked = replace(asked, model=self.robot.model)
        field = built_in_difference(self.scenario, asked)
        if field is not None:
            raise ScenarioError(field, None, "is changed, and needs a new simulation")
        self._begin_anew(asked)

    def _begin_anew(self, scenario: Scenario) -> None:
        """Begins a run of a scenario that the diagram can take up."""
        if any(sink.path is not None for sink in self._sinks):
            raise ScenarioError(
                "seed",
                scenario.seed,
                "a log or a video holds one run: close() completes it",
            )
        with self._lock:
            self._run.begin(scenario)
            self.scenario = scenario
            self._note_begin()

    def release(self) -> None:
        """Lets a harnessed robot down to the ground, and then go.

        Raises:
            ScenarioError: If the scenario has no harness.
        """
        with self._lock:
            self._run.release()
            self._look()

    # ---- state ---------------------------------------------------------------

    @property
    def context(self) -> Context:
        """The root context of the diagram; not for use while another thread simulates.

        Any thread may call all other members. Those that read an output or change
        anything wait until the simulating thread pauses, every 20 ms of simulated time;
        ``time``, ``events`` and the like give the state at the last pause.
        """
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
    def events(self) -> list[Event]:
        """All events so far."""
        return self._log.events

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
        with self._lock:
            return self._run.frame_pose(name)

    @property
    def tick_seconds(self) -> MutableSequence[float]:
        """Wall-clock times of the controller's ticks [s]; empty if it gives none."""
        return self._tick_seconds

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
        with self._lock:
            return self._run.output(name)

    def summary(self) -> dict[str, Any]:
        """Summarizes the run as plain numbers and text, ready for JSON."""
        return make_summary(self, self._wall_time)

    # ---- events --------------------------------------------------------------

    def _look(self, *, anew: bool = False) -> None:
        """Collects events; ``anew`` if the controller was reset since the last look."""
        with self._noted_error():
            self._log.look(self._run, self._programme, anew=anew)

    @contextmanager
    def _noted_error(self) -> Iterator[None]:
        """Keeps the text of an error, so that ``detach`` does not raise it again."""
        try:
            yield
        except Exception as error:  # Not itself: its traceback holds the simulation.
            self._error = f"{type(error).__name__}: {error}"
            raise
