"""The clock on the wall: pace of simulated time, and steady control ticks.

Nothing here changes the result of a simulation.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Iterator
from contextlib import contextmanager

from pydrake.systems.analysis import Simulator
from threadpoolctl import ThreadpoolController

SLACK = 0.1
"""Largest delay on which a slow simulation may still catch up [s]."""
_LINEAR_ALGEBRA = ThreadpoolController()


class Pace:
    """The pace of one simulator.

    Drake counts real time from the simulator's initialization, so that the simulation
    would run too fast after any delay, such as the start of a browser or a user's pause
    between two commands. Here real time does not advance while the simulation pauses.
    """

    def __init__(self, simulator: Simulator) -> None:
        """Starts now, as fast as possible."""
        self._simulator = simulator
        self.forget_all()

    def set_rate(self, rate: float) -> None:
        """Keeps to ``rate`` simulated seconds per second; 0 is as fast as possible."""
        self._simulator.set_target_realtime_rate(rate)
        self.forget_all()

    def forget_lost_time(self) -> None:
        """Starts again if time was lost; called before each part of an advance."""
        rate = self._simulator.get_target_realtime_rate()
        if rate <= 0.0:
            return
        due = (self._sim_time() - self._began_sim) / rate
        if time.perf_counter() - self._began > due + SLACK:
            self.forget_all()

    def forget_all(self) -> None:
        """Starts again, together with the simulated time."""
        self._simulator.ResetStatistics()
        self._began, self._began_sim = time.perf_counter(), self._sim_time()

    def _sim_time(self) -> float:
        return float(self._simulator.get_context().get_time())


@contextmanager
def steady_ticks() -> Iterator[None]:
    """Limits numpy's linear algebra to one thread, and stops cyclic garbage collection.

    The threads of the libraries behind numpy are meant for large matrices: with the
    small matrices of a control tick they take a third of its time. The values that pass
    through a diagram are frozen and without cycles, so that reference counts free them;
    the collector would only traverse them, for milliseconds at a time.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        with _LINEAR_ALGEBRA.limit(limits=1, user_api="blas"):
            yield
    finally:
        if collecting:
            gc.enable()
