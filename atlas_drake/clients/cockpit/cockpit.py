"""Serves the page of a simulation: requests in, frames out, and pauses in between."""

from __future__ import annotations

import importlib.util
import subprocess
import time
import weakref
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from pydrake.geometry import Meshcat

from atlas_drake.clients import session
from atlas_drake.clients.cockpit.calls import call
from atlas_drake.clients.cockpit.link import Link, start_process
from atlas_drake.clients.cockpit.recording import Recording
from atlas_drake.clients.cockpit.run_page import RunPage
from atlas_drake.clients.cockpit.scenario_requests import NextRun
from atlas_drake.clients.cockpit.wire import (
    ACKNOWLEDGED,
    Answer,
    Frame,
    Notice,
    Request,
    Run,
)
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import await_viewer, start_meshcat
from atlas_drake.errors import AtlasError
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation

PERIOD = 0.1
"""Wall time between two frames [s]."""
PAUSED_LOOK = 0.03
"""Wall time between looks at the requests while paused [s]."""
REQUESTS_AT_ONCE = 20
"""Requests that are met at one look, so that a flood of them holds nothing up."""
SHOWN = ("com", "dcm", "cop", "support", "swing", "plan")
"""Overlays that are switched on at first."""
START_PATIENCE = 30.0
"""Longest time in which the page's process starts [s]."""
END_PATIENCE = 10.0
"""Longest time in which it ends once its line is closed [s]."""
PACKAGES = ("aiohttp", "msgpack")
"""What the extra ``cockpit`` installs."""


class CockpitError(AtlasError):
    """The cockpit cannot be opened."""


class Shown(Protocol):
    """What the page shows: a simulation or a log."""

    @property
    def requests(self) -> Mapping[str, Callable[..., Any]]:
        """What the page may ask for, by name."""

    def described(self) -> Run:
        """Describes what stays the same."""

    def frame(self) -> Frame:
        """Shows the present, with the events since the last frame."""


def is_installed() -> bool:
    """Returns True if the optional packages are there."""
    return all(importlib.util.find_spec(package) for package in PACKAGES)


class Cockpit:
    """The page of one simulation, and of those that follow it.

    Example:
        >>> cockpit = Cockpit()
        >>> sim = AtlasSimulation(view=cockpit.meshcat, overlays=cockpit.overlays)
        >>> cockpit.join(sim)

    Attributes:
        meshcat: The 3D view in the page.
        overlays: Switches of its overlays.
        asked_to_stop: Tells whether a pause must end, because the program does.
        next_run: The scenario that is to follow, if the program lets one follow.
    """

    def __init__(
        self,
        host: str = "localhost",
        port: int | None = None,
        overlays: Overlays | None = None,
    ) -> None:
        """Starts to serve a page.

        Args:
            host: Address to listen on; ``*`` stands for all.
            port: Port to listen on, or the next free one; None takes one from 8080.
            overlays: What the 3D view shows.

        Raises:
            CockpitError: If the optional packages are missing, or the page cannot be
                served.
        """
        if not is_installed():
            raise CockpitError(
                f"the cockpit needs {' and '.join(PACKAGES)}: "
                'pip install "atlas-drake[cockpit]"; Meshcat alone works without'
            )
        self.overlays = overlays or Overlays(SHOWN)
        self.meshcat: Meshcat = start_meshcat(say=lambda _text: None)
        self._link, process = start_process(
            "atlas_drake.clients.cockpit.page", host, str(port or 0)
        )
        self._end = weakref.finalize(self, _end, self._link, process)
        hello = self._link.take(1, timeout=START_PATIENCE)
        if not hello or not isinstance(hello[0], str):
            self.close()
            problem = hello[0].problem if hello else "its process has ended"
            text = f"--host: the cockpit cannot be served on {host}: {problem}"
            raise CockpitError(text)
        self._url = hello[0]
        self.asked_to_stop: Callable[[], bool] = lambda: False
        self.next_run = NextRun()
        self.recording = Recording(self.meshcat)
        self._joined: AtlasSimulation | None = None
        self._viewers = 0
        self._acknowledged = True
        self._sent_at = 0.0

    def web_url(self) -> str:
        """Returns the address of the page, with the token that allows to steer."""
        return self._url

    def GetNumActiveConnections(self) -> int:
        """Returns the number of open pages; named as Meshcat's."""
        if self._link.is_open:
            self._meet_requests()
        return self._viewers

    def join(self, sim: AtlasSimulation) -> None:
        """Shows and commands a simulation from now on, in place of the one before.

        Args:
            sim: A simulation whose view is ``meshcat``, with ``overlays``.
        """
        if self._joined is not None:
            self._joined.hooks.remove(self.attend)
        self._joined = sim
        sim.hooks.append(self.attend)
        if self.overlays.recorded:
            self.recording.why_not = "the whole run is recorded already"
        self._page = RunPage(
            sim, self.meshcat, self.overlays, self.next_run, self.recording
        )
        self._send_settings(sim)
        self.present(self._page)

    def present(self, shown: Shown) -> None:
        """Shows a run, or a log, from now on."""
        self._shown = shown
        self._link.send(shown.described())

    def look(self) -> None:
        """Meets requests, and shows the present if it is time."""
        self._meet_requests()
        self._show()

    def say(self, text: str, lasting: bool = False) -> None:
        """Tells every viewer something; the page goes on to show what is lasting."""
        self._link.send(Notice(text, lasting))

    def attend(self, sim: AtlasSimulation) -> None:
        """Meets requests and shows the present; does not return while paused.

        A hook of the simulation.
        """
        clock = self._page.clock
        self._page.watch()
        while True:
            self._meet_requests()
            if sim.scenario is not self._scenario_shown:
                self._send_settings(sim)
            if self._viewers:
                clock.keep_snapshot()
            self._show()
            if not clock.paused or clock.takes_step() or self._must_go_on():
                return
            if not self._link.is_open:
                clock.paused = False  # Nobody can end the pause.
                return
            time.sleep(PAUSED_LOOK)

    def close(self) -> None:
        """Closes the page; the simulation may continue."""
        self._end()

    def _must_go_on(self) -> bool:
        return self.next_run.scenario is not None or self.asked_to_stop()

    def _send_settings(self, sim: AtlasSimulation) -> None:
        self._scenario_shown = sim.scenario
        self._link.send(self._page.settings())

    def _meet_requests(self) -> None:
        """Does what is asked; shows its effect, and then answers."""
        answers = []
        for message in self._link.take(REQUESTS_AT_ONCE):
            if isinstance(message, Request):
                answers.append(self._answer_to(message))
            elif message == ACKNOWLEDGED:
                self._acknowledged = True
            else:
                self._viewers = message
        answers = [answer for answer in answers if answer.number]
        if answers:
            self._send_frame()
        for answer in answers:
            self._link.send(answer)

    def _answer_to(self, request: Request) -> Answer:
        try:
            value = call(self._shown.requests, request.name, request.values)
            return Answer(request.number, value)
        except (AtlasError, ValueError) as error:
            return Answer(request.number, problem=str(error))

    def _show(self) -> None:
        """Sends a frame, unless nobody looks or the last one has not been taken."""
        due = time.perf_counter() - self._sent_at >= PERIOD
        if due and self._acknowledged and self._viewers and self._link.is_open:
            self._send_frame()

    def _send_frame(self) -> None:
        self._acknowledged, self._sent_at = False, time.perf_counter()
        self._link.send(self._shown.frame())


def open_cockpit(
    scenario: Scenario | None = None,
    overlays: Overlays | None = None,
    **arguments: Any,
) -> tuple[AtlasSimulation, Cockpit]:
    """Builds a simulation with a page in the browser that shows and commands it.

    Prints the address, gives a browser the time to open, and lets the run keep to real
    time.

    Args:
        scenario: As for ``AtlasSimulation``.
        overlays: What the 3D view shows.
        **arguments: Further ones of ``AtlasSimulation``, but for ``view``.

    Raises:
        CockpitError: If the optional packages are missing, or the page cannot be
            served; other errors are those of ``AtlasSimulation``.
    """
    cockpit = Cockpit(overlays=overlays)
    view, overlays = cockpit.meshcat, cockpit.overlays
    sim = session.AtlasSimulation(scenario, view=view, overlays=overlays, **arguments)
    cockpit.join(sim)
    await_viewer(cockpit)
    sim.set_realtime_rate(sim.realtime_rate or 1.0)
    return sim, cockpit


def _end(link: Link, process: subprocess.Popen[bytes]) -> None:
    link.close()
    process.wait(END_PATIENCE)
