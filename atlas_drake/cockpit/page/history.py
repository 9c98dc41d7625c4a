"""What the page keeps of the time before: modes, shares, events."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

from atlas_drake.cockpit.state import RunState

SPAN = 60.0
"""Simulated time that is kept [s]."""
MOST_EVENTS = 2000
"""Number of events that are kept."""


class Moment(NamedTuple):
    """A state's time [s], behavior, and the shares of behavior and user, 0 to 1."""

    time: float
    behavior: str
    user: float


class History:
    """The latest moments and events."""

    def __init__(self) -> None:
        """Starts empty."""
        self.moments: deque[Moment] = deque()
        self.events: deque[tuple[float, str, str]] = deque(maxlen=MOST_EVENTS)
        self.samples: deque[tuple[float, Mapping[str, float]]] = deque()
        self._run = 0

    def add(self, state: RunState) -> None:
        """Adds a state."""
        if state.run != self._run:
            self._run = state.run  # Time has jumped: all events come again.
            self.events.clear()
            self.samples.clear()
        if state.past:
            self.moments = deque(Moment(*one) for one in state.past)
        while self.moments and self.moments[-1].time >= state.time:
            self.moments.pop()
        user = sum(state.k_effort) / (255.0 * max(len(state.k_effort), 1))
        self.moments.append(Moment(state.time, state.behavior, user))
        while self.moments[0].time < state.time - SPAN:
            self.moments.popleft()
        self.events.extend(state.events)
        while self.samples and state.samples and self.samples[-1][0] > state.time:
            self.samples.pop()
        self.samples.extend(state.samples)
        while self.samples and self.samples[0][0] < state.time - SPAN:
            self.samples.popleft()
