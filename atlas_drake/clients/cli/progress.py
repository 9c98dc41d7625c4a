"""Output of a run or a campaign on the terminal: events and progress.

Text and terminals only; the simulation provides the content.
"""

from __future__ import annotations

import math
import os
import shutil
import threading
import time
from collections import deque
from datetime import timedelta
from typing import TextIO

from atlas_drake.errors import printable
from atlas_drake.messages.event import PUSH, Event

REPEAT = 5.0
"""Wall time between lines of progress where lines cannot be rewritten [s]."""
RATE_WINDOW = 1.0
"""Wall time over which the real-time factor is measured [s]."""
AGAIN = 2.0
"""Wall time between repetitions of a campaign's progress [s]."""


class StatusLine:
    """A line that says how far something is, below the lines that stay.

    On a terminal the line is rewritten; elsewhere, such as in a log, it is a new line
    every few seconds.
    """

    def __init__(self, stream: TextIO) -> None:
        """Prints to ``stream``."""
        self._stream = stream
        self._live = stream.isatty()
        self._shown = 0
        self._last_line = time.perf_counter()

    def say(self, line: str) -> None:
        """Prints a line that stays."""
        self.clear()
        self._put(printable(line) + "\n")

    def say_lines(self, text: str) -> None:
        """Prints a text of several lines."""
        for line in text.split("\n"):
            self.say(line)

    def show(self, text: str) -> None:
        """Says how far it is."""
        now = time.perf_counter()
        if self._live:
            # A line that is wider than the terminal could not be rewritten.
            text = printable(text)[: shutil.get_terminal_size().columns - 1]
            self._put("\r" + text.ljust(self._shown))
            self._shown = len(text)
        elif now - self._last_line >= REPEAT:
            self._last_line = now
            self.say(text)

    def clear(self) -> None:
        """Takes the rewritten line away, for somebody else to print there."""
        if self._shown:
            self._put("\r" + " " * self._shown + "\r")
            self._shown = 0

    def _put(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except BrokenPipeError:
            # Nobody reads any more, as after | head; the run completes its files.
            nobody = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nobody, self._stream.fileno())
            os.close(nobody)


class Progress(StatusLine):
    """Prints events as lines, and the progress of a run below them."""

    def __init__(self, stream: TextIO, end: float) -> None:
        """Prints to ``stream`` about a run that ends at ``end`` [s], or never."""
        super().__init__(stream)
        self._end = f" of {end:g} s" if math.isfinite(end) else ""
        self._times: deque[tuple[float, float]] = deque()

    def event(self, event: Event) -> None:
        """Prints an event as it happens."""
        self.say(event_line(event))

    def update(self, sim_time: float, behavior: str) -> None:
        """Says how far the run is, at a simulated time [s]."""
        now = time.perf_counter()
        self._times.append((now, sim_time))
        while len(self._times) > 2 and now - self._times[1][0] > RATE_WINDOW:
            self._times.popleft()
        wall = now - self._times[0][0]
        simulated = sim_time - self._times[0][1]
        rate = f"{simulated / wall:.2f} x real time" if wall > 0.0 else ""
        self.show(f"{sim_time:7.2f} s{self._end} | {rate:>16} | {behavior}")


class TrialProgress(StatusLine):
    """How far a campaign is: trials, successes, time left.

    Used as a context, it says so every few seconds, however long a trial takes.
    """

    def __init__(self, stream: TextIO) -> None:
        """Prints to ``stream``."""
        super().__init__(stream)
        self._begin = time.perf_counter()
        self._done = self._successes = 0
        self._latest = "no trial done yet"
        self._lock = threading.RLock()
        self._ended = threading.Event()

    def __enter__(self) -> TrialProgress:
        """Begins to repeat the latest line, with the time so far."""
        threading.Thread(target=self._repeat, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        """Ends it."""
        with self._lock:
            self._ended.set()
            self.clear()

    def _repeat(self) -> None:
        while not self._ended.wait(AGAIN):
            self._show_latest()

    def _show_latest(self) -> None:
        with self._lock:
            if not self._ended.is_set():
                so_far = round(time.perf_counter() - self._begin)
                self.show(f"{self._latest} | {timedelta(seconds=so_far)} so far")

    def update(self, success: bool, done: int, total: int) -> None:
        """Says how far the campaign is, after a trial.

        ``done`` and ``total`` count the trials of earlier calls, too.
        """
        self._done += 1
        self._successes += success
        each = (time.perf_counter() - self._begin) / self._done
        percent = 100.0 * self._successes / self._done
        self._latest = (
            f"{done} of {total} trials | {percent:.0f} % of these {self._done} succeed "
            f"| {timedelta(seconds=round(each * (total - done)))} left"
        )
        self._show_latest()


def event_line(event: Event) -> str:
    """Makes one line about an event; commands stand out, consequences are indented."""
    indent = "" if event.kind in ("command", PUSH) else "  "
    warning = "! " if event.kind in ("fall", "refusal", "warning", "steps left") else ""
    return f"{event.time:7.2f} s {indent}{warning}{event.text}"
