"""Simulated time of a program: calls that wait advance it.

The thread that waits advances the simulation in short pieces; messages are delivered
between pieces. The callback ``ended`` decides when the run ends; the messages are in
``topics``.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

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
    """Ends a program that waits after the end of its run."""


class Clock:
    """The time of one run.

    Attributes:
        sim: The simulation.
        simulating: True while an operation runs that Ctrl-C must not interrupt.
        last_command: Time of the last published message [s].
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
        self._run_ended, self._end = ended, end
        self._shut_down = False
        self._deliver: list[Callable[[], None]] = []
        self._guard = threading.RLock()
        self._next_delivery = sim.time
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

    def shut_down(self) -> None:
        """Ends the run."""
        self._shut_down = True

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

    def deliver_to(self, deliver: Callable[[], None]) -> None:
        """Starts to call ``deliver`` in every control period."""
        self._deliver.append(deliver)
        self._next_delivery = self.sim.time

    def deliver_no_more_to(self, deliver: Callable[[], None]) -> None:
        """Stops the calls of ``deliver``."""
        if deliver in self._deliver:
            self._deliver.remove(deliver)

    def wait(self) -> None:
        """Advances until the run ends, without callbacks."""
        self._deliver.clear()
        self._shut_down = False
        while self.advance_to(self.sim.time + LONGEST_PIECE):
            pass

    def advance_to(self, time: float) -> bool:
        """Advances the simulation and calls callbacks meanwhile.

        Args:
            time: Simulated time to advance to [s].

        Returns:
            True if that time was reached; False if the run ended before.

        Raises:
            SimulationError: If the physics could not be solved.
        """
        self._glances = 0
        while self.sim.time < time - TINY:
            if self.over:
                return False
            with self._guard:
                self._advance_piece(min(time, self._end))
        return True

    def _advance_piece(self, time: float) -> None:
        """Advances to the next delivery, at most until ``time``, and delivers."""
        if self.sim.time >= time - TINY:  # Another thread has advanced meanwhile.
            return
        if self._deliver and self._next_delivery <= self.sim.time + TINY:
            self._next_delivery = self.sim.time + self.period
        stop = min(time, self.sim.time + LONGEST_PIECE)
        if self._deliver:
            stop = min(stop, self._next_delivery)
        with self.undisturbed():
            self.sim.advance_to(round(stop, DIGITS))
        if self._deliver and self.sim.time >= self._next_delivery - TINY:
            for deliver in list(self._deliver):
                deliver()
