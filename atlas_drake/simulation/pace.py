"""Keeps simulated time to real time, without catching up on lost time.

Concerns the clock only, and not the simulated system.
"""

from __future__ import annotations

import time

from pydrake.systems.analysis import Simulator

SLACK = 0.1
"""Largest delay on which a slow simulation may still catch up [s]."""


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
