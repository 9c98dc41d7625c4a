"""Time in the hands of the page: pause, single steps, reset, and back."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages.checks import check_number

if TYPE_CHECKING:
    from atlas_drake.scenario import Scenario
    from atlas_drake.simulation import AtlasSimulation
    from atlas_drake.simulation.run_log import Snapshot

FASTEST = 100.0
"""Largest multiple of real time."""
KEPT_EVERY = 1.0
"""Simulated time between two snapshots that can be gone back to [s]."""
KEPT = 31
"""Number of snapshots that are kept; each takes 2.5 MB."""


class Clock:
    """Pause, single steps, pace, reset, and back in time.

    Attributes:
        paused: True while time stands still.
    """

    def __init__(self, sim: AtlasSimulation) -> None:
        """Lets time run."""
        self._sim = sim
        self.paused = False
        self._steps = 0
        self._snapshots: deque[Snapshot] = deque(maxlen=KEPT)

    def pause(self, on: bool) -> None:
        """Lets time stand still, or run again."""
        self.paused = on

    def step(self) -> None:
        """Simulates one chunk, 20 ms, and then lets time stand still."""
        self.paused = True
        self._steps += 1

    def takes_step(self) -> bool:
        """Counts a single step down; returns False if none was asked for."""
        asked = self._steps > 0
        self._steps = max(self._steps - 1, 0)
        return asked

    def rate(self, rate: float) -> None:
        """Keeps simulated time at a multiple of real time; 0 is as fast as can be."""
        self._sim.set_realtime_rate(check_number(rate, "rate", 0.0, FASTEST))

    def reset(self, seed: int | None = None) -> None:
        """Puts the robot back on its feet; with a seed a new run begins."""
        self._sim.reset(seed=seed)
        if seed is not None:
            self._snapshots.clear()

    def restart(self, scenario: Scenario) -> None:
        """Begins a new run of a scenario that the diagram can simulate."""
        self._sim.restart(scenario)
        self._snapshots.clear()

    def back(self, seconds: float = 10.0) -> float:
        """Goes back in time, as far as snapshots are kept.

        Args:
            seconds: How far [s].

        Returns:
            The time gone back to [s].

        Raises:
            InvalidMessageError: If no snapshot is kept.
            ScenarioError: While a log or a video is written.
        """
        until = self._sim.time - check_number(seconds, "seconds", 0.0)
        if not self._snapshots:
            raise InvalidMessageError(
                "seconds", seconds, "nothing is kept to go back to"
            )
        earlier = [one for one in self._snapshots if one.time <= until + 1e-9]
        snapshot = earlier[-1] if earlier else self._snapshots[0]
        self._sim.restore(snapshot)
        while self._snapshots[-1].time > snapshot.time:
            self._snapshots.pop()
        return snapshot.time

    def keep_snapshot(self) -> None:
        """Keeps the present, if the last one kept is old enough."""
        last = self._snapshots[-1].time if self._snapshots else -KEPT_EVERY
        if self._sim.time >= last + KEPT_EVERY - 1e-9:
            self._snapshots.append(self._sim.snapshot())
