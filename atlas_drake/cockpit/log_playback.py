"""Plays a log in the cockpit: time goes on, stops and jumps as the page asks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram

from atlas_drake.cockpit.clock_controls import FASTEST
from atlas_drake.cockpit.log_state import REFUSAL, state_of_log, user_share
from atlas_drake.cockpit.operator import CONTROLS, carry_out
from atlas_drake.cockpit.orders import Order
from atlas_drake.cockpit.page.history import SPAN
from atlas_drake.cockpit.plot_controls import Sample, check_columns
from atlas_drake.cockpit.recording_controls import RecordingControls
from atlas_drake.cockpit.state import BESIDE, RunState, events_after
from atlas_drake.cockpit.view_controls import ViewControls
from atlas_drake.errors import InvalidMessageError
from atlas_drake.frozen import replace
from atlas_drake.logs.log import Log
from atlas_drake.messages.checks import check_number
from atlas_drake.visualization.overlays import Overlays

PAST_POINTS = 1000
"""Number of rows of the time before a jump that are shown."""
REPLAY_CONTROLS = {
    "clock": ("pause", "go_on", "toggle", "single_step", "pace", "reset", "back"),
    "replay": ("seek",),
    "view": ("show",),
    "plots": ("choose",),
    "recording": ("start", "stop"),
}
"""The controls that the page may use, by group."""


class LogPlayback:
    """A log with a present; it has the controls of a log's page as methods."""

    def __init__(
        self,
        log: Log,
        diagrams: Sequence[Diagram],
        meshcat: Meshcat,
        overlays: Overlays,
        beside: Log | None = None,
    ) -> None:
        """Begins at the log's begin, and plays."""
        self._log, self._beside = log, beside
        self._simulators = [Simulator(diagram) for diagram in diagrams]
        self._begin, self._end = float(log.time[0]), float(log.time[-1])
        self._view = ViewControls(overlays)
        self._recording = RecordingControls(meshcat)
        self._units = log.units
        self._chosen: tuple[str, ...] = ()
        self.time, self.paused, self._pace = self._begin, False, 1.0
        self._shown = -np.inf
        self._sampled = -np.inf
        self._jumps, self._jumped = 0, True
        for simulator in self._simulators:
            simulator.get_mutable_context().SetTime(self.time)
            simulator.Initialize()

    # ---- orders --------------------------------------------------------------

    def do(self, order: Order) -> Any:
        """Carries an order out; returns what its control returns."""
        group, _, name = order.control.partition(".")
        if name not in REPLAY_CONTROLS.get(group, ()) and name in CONTROLS.get(
            group, ()
        ):
            raise InvalidMessageError("control", order.control, REFUSAL)
        groups = {
            "clock": self,
            "replay": self,
            "plots": self,
            "view": self._view,
            "recording": self._recording,
        }
        return carry_out(order, groups, REPLAY_CONTROLS)

    def pause(self) -> None:
        """Lets time stand still."""
        self.paused = True

    def go_on(self) -> None:
        """Lets time run again; from the end, it runs from the begin."""
        self.paused = False
        if self.time >= self._end:
            self.seek(self._begin)

    def toggle(self) -> None:
        """Lets time stand still, or run again."""
        if self.paused:
            self.go_on()
        else:
            self.pause()

    def pace(self, rate: float) -> None:
        """Plays at a multiple of real time; 0 is as fast as a log can be watched."""
        self._pace = check_number(rate, "rate", 0.0, FASTEST)

    def single_step(self) -> None:
        """Shows the next row, and then lets time stand still."""
        self.paused = True
        row = min(self.row + 1, len(self._log) - 1)
        self.time = float(self._log.time[row])

    def back(self, seconds: float = 10.0) -> float:
        """Goes back by ``seconds``, as far as the log goes; returns the time [s]."""
        return self.seek(self.time - check_number(seconds, "seconds", 0.0))

    def reset(self) -> float:
        """Goes back to the begin; returns its time [s]."""
        return self.seek(self._begin)

    def seek(self, time: float) -> float:
        """Goes to a time within the log; returns it [s]."""
        self.time = min(max(check_number(time, "time"), self._begin), self._end)
        self._jumped = True
        return self.time

    def choose(self, names: Sequence[str]) -> None:
        """Plots these columns, such as ``balance.com.x``."""
        self._chosen = check_columns(names, self._units)
        self._jumped = True

    # ---- as time goes on -----------------------------------------------------

    @property
    def row(self) -> int:
        """Number of the row that is shown: the latest that is not in the future."""
        return self._log.row_at(self.time)

    def advance(self, passed: float) -> None:
        """Plays on for some time on the wall [s], and draws."""
        if not self.paused:
            self.time += passed * (self._pace or FASTEST_PLAY)
            if self.time >= self._end:
                self.time, self.paused = self._end, True
        if self.time != self._shown:
            self._shown = self.time
            for simulator in self._simulators:
                context = simulator.get_mutable_context()
                context.SetTime(self.time)
                simulator.get_system().ForcedPublish(context)

    def read(self, events_seen: int) -> RunState:
        """Reads the present state, with the events after the first ``events_seen``.

        After a jump it has the time before, so that plots and modes follow.
        """
        past: tuple[tuple[float, str, float], ...] = ()
        if self._jumped:
            self._jumped, self._jumps, events_seen = False, self._jumps + 1, 0
            self._sampled = self.time - SPAN
            past = self._past()
        samples = self._samples(self._sampled)
        self._sampled = self.time
        until = [e for e in self._log.events if e.time <= self.time + 1e-9]
        new = events_after(until, events_seen)
        return replace(
            state_of_log(self._log, self.row),
            time=self.time,
            rate=0.0 if self.paused else self._pace or FASTEST_PLAY,
            pace=self._pace,
            paused=self.paused,
            overlays=self._view.shown,
            events=new,
            event_count=events_seen + len(new),
            run=self._jumps,
            samples=samples,
            past=past,
            recording=self._recording.is_on,
        )

    def _past(self) -> tuple[tuple[float, str, float], ...]:
        log = self._log
        rows = _rows_between(log, self.time - SPAN, self.time)
        names = [log.behavior(int(n)).name for n in log["behavior.current"][rows]]
        times, shares = log.time[rows].tolist(), user_share(log, rows).tolist()
        return tuple(zip(times, names, shares, strict=True))

    def _samples(self, since: float) -> tuple[Sample, ...]:
        """Returns the numbers of the chosen columns after ``since``, of both logs."""
        if not self._chosen:
            return ()
        logs: list[tuple[Log, Callable[[str], str]]] = [(self._log, str)]
        if self._beside is not None:
            logs.append((self._beside, lambda name: name + BESIDE))
        samples: list[Sample] = []
        for log, named in logs:
            rows = _rows_between(log, since, self.time)
            columns = {named(name): _column(log, name, rows) for name in self._chosen}
            for place, time in enumerate(log.time[rows].tolist()):
                numbers = {name: float(c[place]) for name, c in columns.items()}
                samples.append((time, numbers))
        return tuple(sorted(samples, key=lambda one: one[0]))


FASTEST_PLAY = 10.0
"""Multiple of real time at which a log is played as fast as can be."""


def _rows_between(log: Log, begin: float, end: float) -> np.ndarray:
    """Returns rows after ``begin`` until ``end``, at most ``PAST_POINTS``."""
    first, last = np.searchsorted(log.time, [begin + 1e-9, end + 1e-9], side="right")
    every = max(-(-(last - first) // PAST_POINTS), 1)
    return np.arange(first, last, every)


def _column(log: Log, name: str, rows: np.ndarray) -> np.ndarray:
    """Returns numbers at some rows; NaN if a log of another robot has none."""
    return log[name][rows] if name in log.numbers else np.full(len(rows), np.nan)
