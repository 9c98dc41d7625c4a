"""Runs one program on a simulation.

Views, output files and the verdict on a run are in ``cli``.
"""

from __future__ import annotations

import math
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from atlas_drake.clients.ros_scripts.action_server import ActionServer
from atlas_drake.clients.ros_scripts.actionlib_module import actionlib_names
from atlas_drake.clients.ros_scripts.clock import ENDED, Clock
from atlas_drake.clients.ros_scripts.joint_topics import Trajectory
from atlas_drake.clients.ros_scripts.python2 import load_program
from atlas_drake.clients.ros_scripts.rospy_module import RosNode
from atlas_drake.clients.ros_scripts.unknown import LIST, ScriptError
from atlas_drake.clients.ros_scripts.world import World, as_main, stand_ins
from atlas_drake.simulation import AtlasSimulation, SimulationError


def unfinished(sim: AtlasSimulation) -> list[str]:
    """Names what the robot was still doing for a program when the run ended."""
    steps = len(sim.output("controller_status").plan.footsteps)
    kinds = {
        "a goal of atlas/bdi_control": ActionServer,
        "a joint trajectory": Trajectory,
    }
    return [
        *([f"{steps} step{'s' * (steps > 1)}"] if steps else []),
        *(
            text
            for text, kind in kinds.items()
            if any(isinstance(hook, kind) for hook in sim.hooks)
        ),
    ]


class Program:
    """A program's file; ``at_fault`` is True once it asked for something unknown."""

    def __init__(self, path: Path, arguments: Sequence[str] = ()) -> None:
        """Reads and compiles the file; raises a ScriptError if it cannot be read."""
        self.path, self._arguments = path, list(arguments)
        self._code, self._is_python2 = load_program(path)
        self.at_fault = False
        self._clock: Clock | None = None

    @property
    def simulating(self) -> bool:
        """True while an operation runs that Ctrl-C must not interrupt."""
        return self._clock is not None and self._clock.simulating

    @property
    def last_command(self) -> float:
        """Time of the last published message [s]; -infinity without one."""
        return -math.inf if self._clock is None else self._clock.last_command

    def run(
        self,
        sim: AtlasSimulation,
        ended: Callable[[], bool],
        end: float,
        say: Callable[[str], object],
        complain: Callable[[str], object],
    ) -> str | None:
        """Runs the program; returns None, or what went wrong.

        Args:
            sim: The simulation.
            ended: Tells whether the run is over; called at least every 0.1 s of
                simulated time.
            end: Latest simulated time of the run [s].
            say: Prints a line.
            complain: Prints an error of the program.
        """
        self._clock = clock = Clock(sim, ended, end)
        node = RosNode(clock, say)
        per_run = {"rospy": node.names(), "actionlib": actionlib_names(clock, say)}
        modules = stand_ins(per_run, sim.robot)
        world = World(self.path.resolve().parent, clock, say)

        def run_threads() -> None:
            with suppress(*ENDED):
                world.run(self.path, self._code, main, old=self._is_python2)
                clock.wait_for(clock.only_daemons_left)
            if clock.error is not None:
                raise clock.error

        with as_main(self.path, self._arguments, world, modules) as main:
            try:
                problem = self._outcome(run_threads, complain)
                return problem or self._outcome(node.end, complain)
            finally:
                clock.close()

    def finish(self) -> str | None:
        """Advances from the end of the program to the end of the run."""
        if self._clock is None:
            return None
        self._clock.finish()
        return None if self._clock.error is None else str(self._clock.error)

    def _outcome(
        self, part: Callable[[], object], complain: Callable[[str], object]
    ) -> str | None:
        """Runs a part of the program; returns what went wrong, if anything."""
        try:
            part()
        except ENDED:
            # The run ended while the program waited.
            return None
        except SystemExit as stop:
            if stop.code in (None, 0):
                return None
            if isinstance(stop.code, str):
                complain(stop.code)
                return f"{self.path.name} gave up: {stop.code}"
            return f"{self.path.name} ended with status {stop.code}"
        except SimulationError as error:
            return str(error)
        except Exception as error:
            self.at_fault = isinstance(error, (ScriptError, ImportError))
            complain(self._traceback(error))
            brief = str(error).partition(LIST)[0].rstrip(".")
            return f"{self.path.name}: {type(error).__name__}: {brief}"
        return None

    def _traceback(self, error: Exception) -> str:
        """Return the traceback from the program's first line on."""
        begin = error.__traceback__
        while begin and begin.tb_frame.f_code.co_filename != str(self.path):
            begin = begin.tb_next
        lines = traceback.format_exception(type(error), error, begin, chain=False)
        return "".join(lines).rstrip()
