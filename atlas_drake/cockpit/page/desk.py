"""What all viewers of a page share: the latest state, who steers, open orders."""

from __future__ import annotations

import asyncio
import itertools
import time
from collections.abc import Callable, Sequence
from typing import Any

from atlas_drake.cockpit.link import Link
from atlas_drake.cockpit.orders import ACKNOWLEDGED, Notice, Order, Reply
from atlas_drake.cockpit.page.history import History
from atlas_drake.cockpit.settings import SettingsCard
from atlas_drake.cockpit.state import RunCard, RunState

MOST_OPEN = 30
"""Orders without a reply beyond which further ones are dropped."""
STOP = "modes.stop"
"""The order that every viewer who may steer can give, to end what another one began."""
PATIENCE = 5.0
"""Longest wait for a reply [s]."""


class Refused(Exception):
    """An order that was not carried out; says why."""


class Viewer:
    """One browser's page."""

    _numbers = itertools.count(1)

    def __init__(self, may_steer: bool) -> None:
        self.may_steer = may_steer
        self.name = f"viewer {next(self._numbers)}"
        self.plotted: tuple[str, ...] = ()
        self.show: Callable[[RunState], None] = lambda _state: None
        self.show_card: Callable[[], None] = lambda: None
        self.show_settings: Callable[[], None] = lambda: None
        self.tell: Callable[[str], None] = lambda _text: None


class Desk:
    """The line to the simulation, and the viewers at it."""

    def __init__(self, link: Link) -> None:
        """Talks over a line."""
        self._link = link
        self.card: RunCard | None = None
        self.settings: SettingsCard | None = None
        self.pending: dict[str, Any] = {}
        self.problem = ""
        self.state: RunState | None = None
        self.received = 0.0
        self.history = History()
        self.viewers: list[Viewer] = []
        self.steers: Viewer | None = None
        self.asks: Viewer | None = None
        self._numbers = itertools.count(1)
        self._open: dict[int, asyncio.Future[Any]] = {}

    # ---- from the simulation -------------------------------------------------

    def take(self, message: Any) -> None:
        """Takes a card, a state, a reply or a notice."""
        if isinstance(message, RunState):
            self._link.send(ACKNOWLEDGED)
            self.state, self.received = message, time.monotonic()
            self.history.add(message)
            for viewer in self.viewers:
                viewer.show(message)
        elif isinstance(message, Reply):
            waiting = self._open.pop(message.number, None)
            if waiting is None or waiting.done():
                return
            if message.problem:
                waiting.set_exception(Refused(message.problem))
            else:
                waiting.set_result(message.value)
        elif isinstance(message, RunCard):
            self.card, self.history = message, History()
            for viewer in self.viewers:
                viewer.show_card()
        elif isinstance(message, SettingsCard):
            self.settings, self.pending = message, {}
            for viewer in self.viewers:
                viewer.show_settings()
        elif isinstance(message, Notice):
            self.problem = message.text if message.lasting else ""
            for viewer in self.viewers:
                viewer.tell(message.text)
                viewer.show_settings()

    # ---- to the simulation ---------------------------------------------------

    async def order(self, viewer: Viewer, control: str, **values: Any) -> Any:
        """Sends an order, and waits for its reply."""
        if viewer is not self.steers:
            if control != STOP or not viewer.may_steer:
                raise Refused("You are watching: ask to steer first")
            if self.steers is not None:
                self.steers.tell(f"{viewer.name} pressed STOP")
        return await self._send(control, values)

    async def _send(self, control: str, values: dict[str, Any]) -> Any:
        if len(self._open) >= MOST_OPEN:
            raise Refused("Too many commands at once: this one is dropped")
        number = next(self._numbers)
        waiting = asyncio.get_running_loop().create_future()
        self._open[number] = waiting
        self._link.send(Order(control, values, number))
        try:
            return await asyncio.wait_for(waiting, PATIENCE)
        except TimeoutError:
            raise Refused("The simulation does not answer: is it running?") from None
        finally:
            self._open.pop(number, None)

    async def plot(self, viewer: Viewer, names: Sequence[str]) -> None:
        """Has columns sampled for a viewer, who need not steer."""
        viewer.plotted = tuple(names)
        await self._send("plots.choose", {"names": self._plotted()})

    def _plotted(self) -> list[str]:
        """Returns what any viewer plots."""
        plotted = [name for one in self.viewers for name in one.plotted]
        return list(dict.fromkeys(plotted))

    def set_pending(self, pending: dict[str, Any]) -> None:
        """Lets values wait for a restart, and shows them to all."""
        self.pending = pending
        for viewer in self.viewers:
            viewer.show_settings()

    # ---- viewers -------------------------------------------------------------

    def seat(self, viewer: Viewer) -> None:
        """Adds a page that has opened, or whose connection is back.

        The first one steers.
        """
        if viewer in self.viewers:
            return
        self.viewers.append(viewer)
        if self.steers is None and viewer.may_steer:
            self.steers = viewer
        self._link.send(len(self.viewers))

    def remove_viewer(self, viewer: Viewer) -> None:
        """Removes a page that was closed; a walk that it steered comes to its end."""
        if viewer not in self.viewers:
            return
        self.viewers.remove(viewer)
        self._link.send(len(self.viewers))
        if viewer.plotted:
            self._link.send(Order("plots.choose", {"names": self._plotted()}))
        if self.asks is viewer:
            self.asks = None
        if self.steers is viewer:
            if self.state is not None and self.state.direction is not None:
                self._link.send(Order("walk.stop"))
            able = [one for one in self.viewers if one.may_steer]
            self.steers = self.asks or (able[0] if able else None)
            self.asks = None

    def ask_to_steer(self, viewer: Viewer) -> None:
        """Takes over if nobody steers, and otherwise asks who does."""
        if not viewer.may_steer:
            viewer.tell("Open the address with its token to steer")
        elif self.steers is None:
            self.steers = viewer
        elif self.steers is not viewer:
            self.asks = viewer
            self.steers.tell(f"{viewer.name} asks to steer: Hand over lets them")

    def hand_over(self, viewer: Viewer) -> None:
        """Lets the viewer who asks steer."""
        if viewer is self.steers and self.asks is not None:
            self.steers, self.asks = self.asks, None
            self.steers.tell("You steer now")
