"""The viewers of the page: what they are told, and which of them has control."""

from __future__ import annotations

import asyncio
import itertools
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import orjson

from atlas_drake.clients.cockpit.page.sockets import Pending
from atlas_drake.clients.cockpit.wire import Frame, Notice, Run, Settings, ShownEvent

MOST_VIEWERS = 20
"""Pages that are open at a time with a token, and as many without."""
SILENCE = 30.0
"""Time without an action after which control goes to who asks for it [s]."""
SPAN = 60.0
"""Simulated time of the moments that are kept [s]."""
MOST_EVENTS = 2000
"""Number of events that are kept."""


class Viewer:
    """One browser's page.

    Attributes:
        may_steer: True if it was opened with the token, or needs none.
        name: What others are told that it is.
        pending: What it has not taken yet.
        drop: Ends its connection.
        acted: Time of its last action in control [s].
        open: Number of its requests without an answer.
        has_erred: True once the terminal told of a fault of its connection.
    """

    _numbers = itertools.count(1)

    def __init__(self, may_steer: bool) -> None:
        self.may_steer = may_steer
        self.name = f"Viewer {next(self._numbers)}"
        self.pending = Pending()
        self.drop: Callable[[], object] = lambda: None
        self.acted = 0.0
        self.open = 0
        self.has_erred = False

    def tell(self, kind: str, *, latest: bool = False, **values: Any) -> None:
        """Sends something; in place of what waits, if only the latest counts."""
        self.put(as_json(kind, **values), kind if latest else None)

    def put(self, message: bytes, about: str | None = None) -> None:
        """Sends JSON; ends the connection of a browser that takes none."""
        try:
            self.pending.put(message, about)
        except asyncio.QueueFull:
            self.drop()


def as_json(kind: str, **values: Any) -> bytes:
    """Returns a message for a browser."""
    option = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
    return orjson.dumps({"kind": kind, **values}, option=option)


class Session:
    """All viewers of the page.

    Attributes:
        viewers: Those whose connection is open.
        holder: Who has control, if anybody.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Starts without viewers; a clock tells the time on the wall [s]."""
        self.viewers: list[Viewer] = []
        self.holder: Viewer | None = None
        self._asks: Viewer | None = None
        self._clock = clock
        # Messages for who comes later.
        self._run: bytes | None = None
        self._settings: bytes | None = None
        self._problem: bytes | None = None
        self._history = History()

    # ---- from the simulation -------------------------------------------------

    def show_run(self, run: Run) -> None:
        """Shows another run."""
        self._run = as_json("run", run=orjson.Fragment(run.page))
        self._history = History()
        self._to_all(self._run)

    def show_settings(self, settings: Settings) -> None:
        """Shows other settings."""
        page = orjson.Fragment(settings.page)
        self._settings = as_json("settings", settings=page)
        self._to_all(self._settings)

    def show_frame(self, frame: Frame, **beside: Any) -> None:
        """Shows a frame, with what the page's process knows besides."""
        if self._history.add(frame):
            self._to_all(self._history.as_json())
        elif frame.events:
            self._to_all(as_json("events", events=frame.events))
        page = orjson.Fragment(frame.page)
        self._to_all(as_json("frame", frame=page, **beside), "frame")

    def show_notice(self, notice: Notice) -> None:
        """Tells all something; what is lasting is told to those who come later too."""
        message = as_json("notice", text=notice.text, lasting=notice.lasting)
        self._problem = message if notice.lasting else None
        self._to_all(message)

    def show_stopping(self, viewer: Viewer) -> None:
        """Shows at once that a viewer pressed STOP."""
        self._to_all(as_json("stopping"))
        if self.holder is not None and self.holder is not viewer:
            text = f"{viewer.name} pressed STOP"
            self.holder.tell("notice", text=text, lasting=False)

    def _to_all(self, message: bytes, about: str | None = None) -> None:
        for viewer in list(self.viewers):
            viewer.put(message, about)

    # ---- viewers -------------------------------------------------------------

    def has_room(self, *, may_steer: bool) -> bool:
        """Returns True if another page may open."""
        alike = [one for one in self.viewers if one.may_steer == may_steer]
        return len(alike) < MOST_VIEWERS

    def join(self, viewer: Viewer) -> None:
        """Adds a page that has opened; it gets control if nobody has it."""
        self.viewers.append(viewer)
        history = self._history.as_json()
        for message in (self._run, self._settings, history, self._problem):
            if message is not None:
                viewer.put(message)
        if self.holder is None and viewer.may_steer:
            self._give_to(viewer)
        self._tell_all()

    def leave(self, viewer: Viewer) -> bool:
        """Removes a page that was closed; returns True if it had control."""
        self.viewers.remove(viewer)
        had_control = viewer is self.holder
        self.release_control(viewer)
        return had_control

    # ---- control -------------------------------------------------------------

    def take_control(self, viewer: Viewer) -> None:
        """Gives control that is free, or else asks who has it; the latest asks."""
        if self.holder is None:
            self._give_to(viewer)
        elif viewer is self.holder:
            self.acted(viewer)
        else:
            self._asks = viewer
        self.pass_on()
        self._tell_all()

    def release_control(self, viewer: Viewer) -> None:
        """Gives control to who asks, if any; who asks asks no longer."""
        if viewer is self._asks:
            self._asks = None
        elif viewer is self.holder:
            self.holder = None
            if self._asks is not None:
                self._give_to(self._asks)
        self._tell_all()

    def acted(self, viewer: Viewer) -> None:
        """Notes an action of a viewer."""
        viewer.acted = self._clock()

    def pass_on(self) -> None:
        """Gives control to who asks, if who has it has been silent."""
        holder = self.holder
        if holder is None or self._asks is None:
            return
        if self._clock() - holder.acted >= SILENCE:
            self.release_control(holder)

    def _give_to(self, viewer: Viewer) -> None:
        self.holder, self._asks = viewer, None
        self.acted(viewer)

    def _tell_all(self) -> None:
        for viewer in self.viewers:
            control = "nobody" if self.holder is None else "other"
            viewer.tell(
                "session",
                latest=True,
                may_steer=viewer.may_steer,
                control="you" if viewer is self.holder else control,
                asked=viewer is self.holder and self._asks is not None,
                asking=viewer is self._asks,
            )


class History:
    """Moments and events of the time before, for viewers that open later."""

    def __init__(self) -> None:
        """Starts empty."""
        self._moments: deque[tuple[float, str, float]] = deque()
        self._events: deque[ShownEvent] = deque(maxlen=MOST_EVENTS)
        self._run: int | None = None

    def add(self, frame: Frame) -> bool:
        """Adds a frame; returns True if time has jumped."""
        has_jumped = self._run not in (None, frame.run)
        if has_jumped:
            self._events.clear()  # All of them come again.
        self._run = frame.run
        moments = self._moments
        while moments and moments[-1][0] >= frame.time:
            moments.pop()
        moments.append((frame.time, frame.behavior, frame.user))
        while moments[0][0] < frame.time - SPAN:
            moments.popleft()
        self._events.extend(frame.events)
        return has_jumped

    def as_json(self) -> bytes:
        """Returns the message for a browser."""
        moments, events = list(self._moments), list(self._events)
        return as_json("history", moments=moments, events=events)
