"""Simulated time of a program, and the turns of its threads.

One thread of a program runs at a time, until it waits: for a time, or for another
thread. Simulated time passes only while all threads wait, so that two runs are equal.
The callback ``ended`` decides when the run ends. Threads are in ``threads``, messages
in ``topics``.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from atlas_drake.ros_scripts.unknown import ScriptError
from atlas_drake.simulation import AtlasSimulation

LONGEST_PIECE = 0.1
"""Simulated time between two looks at whether the run has ended [s]."""
GLANCES = 20
"""Number of queries of the time that take no simulated time. After so many queries in a
row one control period passes, so that a loop that polls the time makes progress."""
TINY = 1e-9
"""Tolerance of comparisons between times [s]."""
DIGITS = 9
"""Decimals to which times are rounded, so that sums of many periods do not drift."""


class RunEnded(SystemExit):
    """Ends a thread that waits after the end of its run."""


class RosError(Exception):
    """``rospy.ROSException``."""


class RosInterruptError(RosError):
    """``rospy.ROSInterruptException``: the run ended during a wait."""


ENDED = RunEnded, RosInterruptError
"""Errors that end a thread of a program when the run has ended."""


class Turn:
    """The wait of one thread for its turn.

    Attributes:
        ready: Tells whether the thread can go on; other threads change it.
        deadline: Simulated time at which it goes on in any case [s].
        given: Set when it is this thread's turn.
    """

    def __init__(self, ready: Callable[[], object], deadline: float = math.inf) -> None:
        self.ready, self.deadline = ready, deadline
        self.given = threading.Event()


class Clock:
    """The time of one run.

    Attributes:
        sim: The simulation.
        simulating: True while an operation runs that Ctrl-C must not interrupt.
        last_command: Time of the last published message [s].
        error: Error of a callback or of the simulation, which ended the run.
        threads: The program's threads; the first one is its main thread.
    """

    def __init__(
        self, sim: AtlasSimulation, ended: Callable[[], bool], end: float
    ) -> None:
        """Starts at the simulation's present time.

        Args:
            sim: The simulation to advance.
            ended: Tells whether the run is over, and may show progress.
            end: Latest simulated time of the run [s].
        """
        self.sim = sim
        self.simulating = False
        self.last_command = -math.inf
        self.error: BaseException | None = None
        self.threads = [threading.current_thread()]
        self._run_ended, self._end = ended, end
        self._shut_down = self._closed = False
        self._waiting: list[Turn] = []
        self._glances = 0

    @property
    def now(self) -> float:
        """Simulated time [s]; counts as a query, see ``GLANCES``."""
        self.glance()
        return self.sim.time

    @property
    def over(self) -> bool:
        """True if the run is over and time no longer passes."""
        return self._shut_down or self._run_ended() or self.sim.time >= self._end - TINY

    def shut_down(self, error: BaseException | None = None) -> None:
        """Ends the run, because of ``error`` if one is given."""
        self._shut_down = True
        self.error = self.error or error

    def close(self) -> None:
        """Ends the run, and every thread that waits."""
        self._shut_down = self._closed = True
        for turn in self._waiting:
            turn.given.set()

    @contextmanager
    def undisturbed(self) -> Iterator[None]:
        """Marks an operation on the simulation that Ctrl-C must not interrupt."""
        before, self.simulating = self.simulating, True
        try:
            yield
        finally:
            self.simulating = before

    def glance(self) -> None:
        """Counts a query of the time; advances after ``GLANCES`` of them."""
        self._glances += 1
        if self._glances > GLANCES and not self.over:
            self.advance_to(self.sim.time + self.period)

    @property
    def period(self) -> float:
        """Simulated time between two messages of a topic: the control period [s]."""
        return self.sim.scenario.control_period

    def finish(self) -> None:
        """Advances from the end of the program to the end of the run.

        Raises:
            SimulationError: If the physics could not be solved.
        """
        while not self._run_ended() and self.sim.time < self._end - TINY:
            self._advance(self._end)

    def advance_to(self, time: float) -> bool:
        """Waits until a simulated time [s].

        Returns:
            True if that time was reached; False if the run ended before.
        """
        try:
            self.wait_until(lambda: False, time)
        except RunEnded:
            return False
        return True

    def wait_until(
        self, ready: Callable[[], object], deadline: float = math.inf
    ) -> None:
        """Lets other threads run, and time pass, until ``ready()`` or the deadline [s].

        Raises:
            RunEnded: If the run ended before.
            ScriptError: If the program did not start the present thread.
        """
        if threading.current_thread() not in self.threads:
            raise ScriptError(
                f"{threading.current_thread().name} waits, but was not started by "
                "threading.Thread of the program; only such threads can wait"
            )
        self._glances = 0
        if ready() or deadline <= self.sim.time + TINY:
            return
        turn = Turn(ready, deadline)
        self.queue(turn)
        self.pass_on()
        self.take(turn)
        if not ready() and self.sim.time < deadline - TINY:
            raise RunEnded

    def queue(self, turn: Turn) -> None:
        """Puts a thread behind those that wait."""
        self._waiting.append(turn)

    def take(self, turn: Turn) -> None:
        """Blocks the present thread until its turn.

        Raises:
            RunEnded: If the program is closed.
        """
        try:
            turn.given.wait()
        finally:
            if turn in self._waiting:  # Ctrl-C came.
                self._waiting.remove(turn)
        if self._closed:
            raise RunEnded

    def pass_on(self) -> None:
        """Gives the turn to the next thread; simulates until there is one."""
        while self._waiting and not self._closed:
            due = self.sim.time + TINY
            turns = (t for t in self._waiting if t.deadline <= due or t.ready())
            turn = next(turns, None)
            if turn is None and self.over:
                # Those that sleep go first: others may wait for them.
                turn = min(self._waiting, key=lambda turn: turn.deadline)
            if turn is not None:
                self._waiting.remove(turn)
                turn.given.set()
                return
            try:
                self._advance(min(turn.deadline for turn in self._waiting))
            except Exception as error:
                self.shut_down(error)

    def _advance(self, time: float) -> None:
        """Simulates until ``time`` [s], or until the next look at the run's end."""
        stop = min(time, self._end, self.sim.time + LONGEST_PIECE)
        with self.undisturbed():
            self.sim.advance_to(round(stop, DIGITS))
