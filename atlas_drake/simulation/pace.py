"""Keeps simulated time to real time, and makes up for no time that was lost.

About the clock alone; what is simulated is not known here.
"""

from __future__ import annotations

import time

from pydrake.systems.analysis import Simulator

SLACK = 0.1
"""How far a simulation that falls behind may still hurry to catch up [s]."""


class Pace:
    """The pace of one simulator.

    Drake counts real time from the simulator's initialization, so that whatever was
    waited for since then, a browser or somebody's thoughts between two commands, would
    be followed by a rush. Here real time stands still when the simulation does.
    """

    def __init__(self, simulator: Simulator) -> None:
        """Begins now, as fast as can be."""
        self._simulator = simulator
        self._begin()

    def set_rate(self, rate: float) -> None:
        """Keeps to ``rate`` simulated seconds per second; 0 is as fast as can be."""
        self._simulator.set_target_realtime_rate(rate)
        self._begin()

    def forget_all(self) -> None:
        """Begins anew, as the simulated time does."""
        self._begin()

    def forget_lost_time(self) -> None:
        """Begins anew if time was lost; called before each piece of an advance."""
        rate = self._simulator.get_target_realtime_rate()
        if rate <= 0.0:
            return
        due = (self._sim_time() - self._began_sim) / rate
        if time.perf_counter() - self._began > due + SLACK:
            self._begin()

    def _begin(self) -> None:
        self._simulator.ResetStatistics()
        self._began, self._began_sim = time.perf_counter(), self._sim_time()

    def _sim_time(self) -> float:
        return float(self._simulator.get_context().get_time())
