"""Simulated time of a program, and the turns of its threads.

The main thread of a program simulates while it waits. Whenever another thread's wait is
over, that thread runs until it waits again, and time stands still meanwhile: one thread
runs at a time, in an order that does not change from run to run. The callback ``ended``
decides when the run ends.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from atlas_drake.clients.ros_scripts.unknown import ScriptError
from atlas_drake.simulation import AtlasSimulation, SimulationError

MAX_PIECE = 0.1
"""Maximum simulated time between two looks at whether the run has ended [s]."""
MAX_QUERIES = 20
"""Number of queries of the time that take no simulated time. After so many queries in a
row one control period passes, so that a loop that polls the time makes progress."""
TOLERANCE = 1e-9
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


@dataclass(eq=False)
class _Wait:
    """The wait of a thread for a simulated time [s], and then for its turn."""

    until: float
    turn: threading.Event = field(default_factory=threading.Event)


class Clock:
    """The time of one run.

    Attributes:
        sim: The simulation.
        simulating: True while an operation runs that Ctrl-C must not interrupt.
        paused: True while the program pauses the physics; ``time.sleep`` is then of
            real time, in which the simulation stands still.
        last_command: Time of the last published message [s].
        error: Error of a callback or of the simulation, which ended the run.
    """

    def __init__(
        self, sim: AtlasSimulation, ended: Callable[[], bool], end: float
    ) -> None:
        """Starts at the simulation's time; the run lasts to ``end`` [s] at most."""
        self.sim = sim
        self.simulating = self.paused = False
        self.last_command = -math.inf
        self.error: BaseException | None = None
        self._main = threading.current_thread()
        self._run_ended, self._end = ended, end
        self._shut_down = self._closed = False
        self._waiting: list[_Wait] = []
        self._threads: list[threading.Thread] = []
        self._turn_over = threading.Semaphore(0)
        self._queries = 0

    def now(self) -> float:
        """Returns the simulated time [s]; counts as a query, see ``MAX_QUERIES``."""
        self.count_query()
        return self.sim.time

    @property
    def period(self) -> float:
        """Simulated time between two messages of a topic: the control period [s]."""
        return self.sim.scenario.control_period

    @property
    def over(self) -> bool:
        """True if the run is over and time no longer passes."""
        return self._shut_down or self._run_ended() or self._reached(self._end)

    def shut_down(self, error: BaseException | None = None) -> None:
        """Ends the run, because of ``error`` if one is given."""
        self._shut_down = True
        self.error = self.error or error

    def close(self) -> None:
        """Ends the run, and every thread that waits."""
        self._shut_down = self._closed = True
        for wait in self._waiting:
            wait.turn.set()

    @contextmanager
    def undisturbed(self) -> Iterator[None]:
        """Marks an operation on the simulation that Ctrl-C must not interrupt."""
        before, self.simulating = self.simulating, True
        try:
            yield
        finally:
            self.simulating = before

    def count_query(self) -> None:
        """Counts a query of the time; advances after ``MAX_QUERIES`` of them."""
        self._queries += 1
        if self._queries > MAX_QUERIES:
            self.advance_to(self.sim.time + self.period)

    def finish(self) -> None:
        """Advances from the end of the program to the end of the run."""
        while not (self._run_ended() or self._reached(self._end) or self.error):
            self._simulate(self._end)

    def advance_to(self, time: float) -> bool:
        """Waits until a simulated time [s]; returns False if the run ended before."""
        self._queries = 0
        thread = threading.current_thread()
        if thread is self._main:
            self._run_until(time)
        elif thread not in self._threads:
            raise ScriptError(
                f"{thread.name} waits, but is no threading.Thread of the program"
            )
        elif not self._reached(time):
            wait = self._queued(time)
            self._turn_over.release()
            self._take_turn(wait)
        return self._reached(time)

    def wait_for(self, ready: Callable[[], bool], timeout: float = math.inf) -> bool:
        """Waits until ``ready()``, asked once per control period.

        Returns False if ``timeout`` [s] passed before.
        """
        end = self.sim.time + timeout
        while not ready():
            if self._reached(end):
                return False
            if not self.advance_to(min(end, self.sim.time + self.period)):
                if ready():
                    break
                raise RunEnded
        return True

    def start(self, thread: threading.Thread) -> None:
        """Starts a thread, whose first turn comes when the main thread waits."""
        run, wait = thread.run, self._queued(self.sim.time)
        self._threads.append(thread)

        def run_in_turn() -> None:
            try:
                with suppress(*ENDED):
                    self._take_turn(wait)
                    run()
            finally:
                self._threads.remove(thread)
                self._turn_over.release()

        thread.run = run_in_turn  # type: ignore[method-assign]
        threading.Thread.start(thread)

    def start_callbacks(self, loop: Callable[[], object]) -> None:
        """Runs a loop of callbacks in a thread; an error there ends the run."""

        def run() -> None:
            try:
                # The program may end while callbacks wait for their turn.
                with suppress(*ENDED):
                    loop()
            except BaseException as error:
                self.shut_down(error)

        thread = threading.Thread(target=run, daemon=True)
        self.start(thread)

    def is_running(self, thread: threading.Thread) -> bool:
        """Tells whether a thread has started and not ended."""
        return thread in self._threads

    def only_daemons_left(self) -> bool:
        """Tells whether all other threads are daemons, which end with the program."""
        return all(thread.daemon for thread in self._threads)

    def _reached(self, time: float) -> bool:
        return self.sim.time >= time - TOLERANCE

    def _queued(self, time: float) -> _Wait:
        wait = _Wait(time)
        self._waiting.append(wait)
        return wait

    def _take_turn(self, wait: _Wait) -> None:
        """Blocks the present thread until its turn."""
        if not self._closed:
            wait.turn.wait()
        if self._closed:
            raise RunEnded

    def _run_until(self, time: float) -> None:
        """Simulates until a time or the end; lets threads run whose wait is over.

        Of the waits that end at the same time, that which began first ends first, and
        that of the main thread last: what it waited for has then arrived.
        """
        own = self._queued(time)
        while own in self._waiting:
            over = self.over
            due = [w for w in self._waiting if over or self._reached(w.until)]
            due.sort(key=lambda wait: wait is own)
            for wait in due:
                self._waiting.remove(wait)
                if wait is own:
                    return
                wait.turn.set()
                self._turn_over.acquire()
            if not due:
                self._simulate(min(wait.until for wait in self._waiting))

    def _simulate(self, time: float) -> None:
        """Simulates until ``time`` [s], or until the next look at the run's end."""
        stop = min(time, self._end, self.sim.time + MAX_PIECE)
        try:
            with self.undisturbed():
                self.sim.advance_to(round(stop, DIGITS))
        except SimulationError as error:
            self.shut_down(error)
