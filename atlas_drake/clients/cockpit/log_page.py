"""A log as the page sees it: time goes on, stops and jumps as the page asks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import orjson
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram

from atlas_drake.clients.cockpit.calls import offered
from atlas_drake.clients.cockpit.clock import FASTEST
from atlas_drake.clients.cockpit.describe import describe_log, thinned
from atlas_drake.clients.cockpit.frame import frame_json
from atlas_drake.clients.cockpit.recording import Recording
from atlas_drake.clients.cockpit.wire import Frame, Run
from atlas_drake.clients.logs.log import Log
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.messages.checks import check_number

FASTEST_PLAY = 10.0
"""Multiple of real time at which a log is played as fast as can be."""
MOST_POINTS = 4000
"""Number of points of a curve that the page gets."""
MOST_COLUMNS = 24
"""Number of columns that can be asked for at a time."""


class LogPage:
    """A log with a present, and what the page may ask of it.

    Attributes:
        requests: What the page may ask for, by name.
    """

    def __init__(
        self,
        log: Log,
        diagrams: Sequence[Diagram],
        meshcat: Meshcat,
        overlays: Overlays,
        beside: Log | None = None,
    ) -> None:
        """Begins at the log's begin, and plays.

        Args:
            log: The log.
            diagrams: Replay it, and the log beside it, in the 3D view.
            meshcat: The 3D view.
            overlays: What it shows.
            beside: A second log, for plots.
        """
        self._log, self._beside = log, beside
        self._meshcat, self._overlays = meshcat, overlays
        self._simulators = [Simulator(diagram) for diagram in diagrams]
        self._begin, self._end = float(log.time[0]), float(log.time[-1])
        self._recording = Recording(meshcat)
        self.time, self.paused, self._pace = self._begin, False, 1.0
        self._shown = -np.inf
        for simulator in self._simulators:
            simulator.get_mutable_context().SetTime(self.time)
            simulator.Initialize()
        self.requests = offered(
            pause=self._pause,
            step=self._step,
            rate=self.rate,
            reset=self._reset,
            back=self._back,
            seek=self.seek,
            show=self._show,
            record=self._recording.record,
            columns=self.columns,
        )

    def described(self) -> Run:
        """Describes the log."""
        page = orjson.dumps(describe_log(self._log, self._beside))
        return Run(page, self._meshcat.port())

    # ---- requests ------------------------------------------------------------

    def _pause(self, on: bool) -> None:
        """Lets time stand still, or run again: from the end, from the begin."""
        self.paused = on
        if not on and self.is_over:
            self.seek(self._begin)

    def _step(self) -> None:
        """Shows the next row, and then lets time stand still."""
        self.paused = True
        row = min(self.row + 1, len(self._log) - 1)
        self.time = float(self._log.time[row])

    def rate(self, rate: float) -> None:
        """Plays at a multiple of real time; 0 is as fast as a log can be watched."""
        self._pace = check_number(rate, "rate", 0.0, FASTEST)

    def _reset(self) -> float:
        return self.seek(self._begin)

    def _back(self, seconds: float = 10.0) -> float:
        return self.seek(self.time - check_number(seconds, "seconds", 0.0))

    def seek(self, time: float) -> float:
        """Goes to a time within the log; returns it [s]."""
        self.time = min(max(check_number(time, "time"), self._begin), self._end)
        return self.time

    def _show(self, overlay: str, on: bool) -> None:
        """Switches an overlay."""
        self._overlays.switch(overlay, on)
        self._shown = -np.inf

    def columns(self, names: Sequence[str]) -> dict[str, Any]:
        """Returns whole columns by name, thinned, each with that of the log beside.

        Raises:
            InvalidMessageError: If one is unknown, or there are too many.
        """
        if len(names) > MOST_COLUMNS:
            rule = f"at most {MOST_COLUMNS} can be plotted at a time"
            raise InvalidMessageError("names", len(names), rule)
        for name in names:
            if name not in self._log.numbers:
                hint = did_you_mean(str(name), self._log.numbers)
                problem = f"there is no such column.{hint}"
                raise InvalidMessageError("names", name, problem)
        beside = self._beside
        return {
            name: {
                **_curve(self._log, name),
                "beside": None if beside is None else _curve(beside, name),
            }
            for name in names
        }

    # ---- as time goes on -----------------------------------------------------

    @property
    def row(self) -> int:
        """Number of the row that is shown: the latest that is not in the future."""
        return self._log.row_at(self.time)

    @property
    def is_over(self) -> bool:
        """True at the end of the log."""
        return self.time >= self._end

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

    def frame(self) -> Frame:
        """Shows the present; the page has all events of a log already."""
        catalog = self._log.header.catalog
        record = self._log.record(self.row)
        rate = 0.0 if self.paused else self._pace or FASTEST_PLAY
        facts: dict[str, Any] = {
            "time": self.time,
            "rate": rate,
            "pace": self._pace,
            "paused": self.paused,
            "tick_ms": 1e3 * (record.controller.tick_time or 0.0),
            "failure": None,
            "run": 0,
            "refusals": {},
            "overlays": sorted(self._overlays.on),
            "recording": self._recording.is_on,
        }
        return Frame(
            page=frame_json(record, catalog, None, **facts),
            run=0,
            time=self.time,
            rate=rate,
            behavior=catalog.find(record.behavior.current).name,
            user=float(record.joints.k.mean()),
        )


def _curve(log: Log, name: str) -> dict[str, list[float | None]]:
    """Returns times and values of a column; no values if a log has no such column."""
    if name not in log.numbers:
        return {"time": [], "value": []}
    rows = thinned(len(log), MOST_POINTS)
    values: list[float] = log.numbers[name][rows].astype(float).tolist()
    return {
        "time": log.time[rows].tolist(),
        "value": [value if math.isfinite(value) else None for value in values],
    }
