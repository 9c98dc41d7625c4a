"""Output of a run on the terminal: events and progress.

Text and terminals only; the simulation provides the content.
"""

from __future__ import annotations

import math
import shutil
import time
from collections import deque
from typing import TextIO

from atlas_drake.messages.event import FOOTSTEP, Event

REPEAT = 5.0
"""Wall time between lines of progress where lines cannot be rewritten [s]."""
RATE_WINDOW = 1.0
"""Wall time over which the real-time factor is measured [s]."""

_FEET = ("left", "right")


class Progress:
    """Prints events as lines, and progress below them.

    On a terminal progress is one line that is rewritten; elsewhere, such as in a log,
    it is a new line every few seconds.
    """

    def __init__(self, stream: TextIO, end: float) -> None:
        """Prints to ``stream`` about a run that ends at ``end`` [s], or never."""
        self._stream = stream
        self._end = end
        self._live = stream.isatty()
        self._shown = 0
        self._last_line = time.perf_counter()
        self._times: deque[tuple[float, float]] = deque()

    def event(self, event: Event) -> None:
        """Prints an event as it happens."""
        self.say(event_line(event))

    def say(self, line: str) -> None:
        """Prints a line that stays."""
        self.clear()
        self._stream.write(line + "\n")
        self._stream.flush()

    def update(self, sim_time: float, behavior: str) -> None:
        """Updates the line of progress.

        Args:
            sim_time: Simulated time [s].
            behavior: Name of the behavior that is active.
        """
        now = time.perf_counter()
        self._times.append((now, sim_time))
        while len(self._times) > 2 and now - self._times[1][0] > RATE_WINDOW:
            self._times.popleft()
        wall = now - self._times[0][0]
        simulated = sim_time - self._times[0][1]
        rate = f"{simulated / wall:.2f} x real time" if wall > 0.0 else ""
        end = f" of {self._end:g} s" if math.isfinite(self._end) else ""
        text = f"{sim_time:7.2f} s{end} | {rate:>16} | {behavior}"
        if self._live:
            # A line that is wider than the terminal could not be rewritten.
            text = text[: shutil.get_terminal_size().columns - 1]
            self._stream.write("\r" + text.ljust(self._shown))
            self._stream.flush()
            self._shown = len(text)
        elif now - self._last_line >= REPEAT:
            self._last_line = now
            self.say(text)

    def clear(self) -> None:
        """Takes the rewritten line away, for somebody else to print there."""
        if self._shown:
            self._stream.write("\r" + " " * self._shown + "\r")
            self._shown = 0


def event_line(event: Event) -> str:
    """Makes one line about an event; commands stand out, consequences are indented."""
    text = event.text
    if event.kind == FOOTSTEP:
        error = 1000.0 * event.data["error_m"]
        text += f" ({_FEET[event.data['foot']]}, {error:.0f} mm off)"
    indent = "" if event.kind in ("command", "push") else "  "
    warning = "! " if event.kind in ("fall", "refusal", "warning", "steps left") else ""
    return f"{event.time:7.2f} s {indent}{warning}{text}"
