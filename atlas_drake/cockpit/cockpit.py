"""Joins a simulation to its page: orders in, states out, and pauses in between."""

from __future__ import annotations

import importlib.util
import subprocess
import time
import weakref
from collections.abc import Callable
from typing import Any, Protocol

from pydrake.geometry import Meshcat

from atlas_drake.cockpit.card import card_of
from atlas_drake.cockpit.link import Link, start_process
from atlas_drake.cockpit.next_run import NextRun
from atlas_drake.cockpit.observe import Observer
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.orders import ACKNOWLEDGED, Notice, Order, Reply
from atlas_drake.cockpit.plan_marks import PlanMarks
from atlas_drake.cockpit.recording_controls import RecordingControls
from atlas_drake.cockpit.setting_list import settings_card
from atlas_drake.cockpit.settings import SettingsCard
from atlas_drake.cockpit.state import RunCard, RunState
from atlas_drake.errors import AtlasError
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import await_viewer, start_meshcat

PERIOD = 0.1
"""Wall time between two states [s]."""
PAUSED_LOOK = 0.03
"""Wall time between looks at the orders while paused [s]."""
MOST_ORDERS = 20
"""Orders that are carried out at one look, so that a flood of them holds nothing up."""
SHOWN = ("com", "dcm", "cop", "support", "swing", "plan")
"""Overlays that are switched on at first."""


class CockpitError(AtlasError):
    """The cockpit cannot be opened."""


class Controls(Protocol):
    """What carries the page's orders out."""

    def do(self, order: Order) -> Any:
        """Carries an order out; returns what its control returns."""


class States(Protocol):
    """What reads the states that the page shows."""

    def read(self, events_seen: int) -> RunState:
        """Reads the present state, with the events after the first ones."""


class Cockpit:
    """The page of one simulation, and of those that follow it.

    Example:
        >>> cockpit = Cockpit()
        >>> sim = AtlasSimulation(view=cockpit.meshcat, overlays=cockpit.overlays)
        >>> cockpit.join(sim)

    Attributes:
        meshcat: The 3D view in the page.
        overlays: Switches of its overlays.
        operator: The controls, once a simulation has joined.
        recording: Records the 3D view.
        asked_to_stop: Tells whether a pause must end, because the program does.
        next_run: The scenario that is to follow, if the program lets one follow.
    """

    operator: Operator

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
        for package in ("nicegui", "msgpack"):
            if importlib.util.find_spec(package) is None:
                raise CockpitError(
                    f"the cockpit needs {package}, which is not installed: "
                    'pip install "atlas-drake[cockpit]"; Meshcat alone works without'
                )
        self.overlays = overlays or Overlays(SHOWN)
        self.meshcat: Meshcat = start_meshcat(say=lambda _text: None)
        self._link, process = start_process(
            "atlas_drake.cockpit.page", host, str(port or 0)
        )
        self._end = weakref.finalize(self, _end, self._link, process)
        hello = self._link.take(1, timeout=START_PATIENCE)
        if not hello or not isinstance(hello[0], str):
            self.close()
            problem = hello[0].problem if hello else "its process has ended"
            raise CockpitError(f"the cockpit cannot be served on {host}: {problem}")
        self._url = hello[0]
        self.asked_to_stop: Callable[[], bool] = lambda: False
        self.next_run = NextRun()
        self.recording = RecordingControls(self.meshcat)
        self._joined: AtlasSimulation | None = None
        self._viewers = 0
        self._acknowledged = True
        self._sent_at = 0.0
        self._events_seen = 0

    def web_url(self) -> str:
        """Returns the address of the page, with the token that allows to steer."""
        return self._url

    def GetNumActiveConnections(self) -> int:
        """Returns the number of open pages; named as Meshcat's."""
        if self._link.is_open:
            self._carry_out_orders()
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
        self.operator = Operator(sim, self.overlays, self.next_run, self.recording)
        self._plan_marks = PlanMarks(self.meshcat, sim.robot)
        observer = Observer(sim, self.operator)
        self._link.send(self._settings_of(sim))
        self.present(self.operator, observer, card_of(sim, self.meshcat.port()))

    def present(self, controls: Controls, states: States, card: RunCard) -> None:
        """Shows a run, or a log, from now on.

        Args:
            controls: Carries orders out.
            states: Reads the states.
            card: What stays the same.
        """
        self._controls, self._states = controls, states
        self._events_seen = 0
        self._link.send(card)

    def look(self) -> None:
        """Carries out orders, and shows the state if it is time."""
        self._carry_out_orders()
        self._show()

    def say(self, text: str, lasting: bool = False) -> None:
        """Tells every viewer something; the page goes on to show what is lasting."""
        self._link.send(Notice(text, lasting))

    def _settings_of(self, sim: AtlasSimulation) -> SettingsCard:
        self._scenario_shown = sim.scenario
        return settings_card(sim.scenario, self.next_run.why_not)

    def attend(self, sim: AtlasSimulation) -> None:
        """Carries out orders and shows the state; does not return while paused.

        A hook of the simulation.
        """
        clock = self.operator.clock
        while True:
            self._carry_out_orders()
            if sim.scenario is not self._scenario_shown:
                self._link.send(self._settings_of(sim))
            self.operator.update(sim.time)
            self._plan_marks.show(self.operator.walk)
            if self._viewers:
                clock.keep_snapshot()
            self._show()
            if not clock.paused or clock.takes_step() or self._must_go_on():
                return
            if not self._link.is_open:
                clock.go_on()  # Nobody can.
                return
            time.sleep(PAUSED_LOOK)

    def _must_go_on(self) -> bool:
        return self.next_run.scenario is not None or self.asked_to_stop()

    def close(self) -> None:
        """Closes the page; the simulation may continue."""
        self._end()

    def _carry_out_orders(self) -> None:
        for message in self._link.take(MOST_ORDERS):
            if isinstance(message, Order):
                self._link.send(self._reply_to(message))
                self._sent_at = 0.0  # Its effect is shown at once.
            elif message == ACKNOWLEDGED:
                self._acknowledged = True
            else:
                self._viewers = message

    def _reply_to(self, order: Order) -> Reply:
        try:
            return Reply(order.number, self._controls.do(order))
        except (AtlasError, ValueError) as error:
            return Reply(order.number, problem=str(error))

    def _show(self) -> None:
        """Sends a state, unless nobody looks or the last one has not been taken."""
        now = time.perf_counter()
        due = now - self._sent_at >= PERIOD
        if not (due and self._acknowledged and self._viewers and self._link.is_open):
            return
        state = self._states.read(self._events_seen)
        self._events_seen = state.event_count
        self._acknowledged, self._sent_at = False, now
        self._link.send(state)


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
    sim = AtlasSimulation(scenario, view=view, overlays=overlays, **arguments)
    cockpit.join(sim)
    await_viewer(cockpit)
    sim.set_realtime_rate(sim.realtime_rate or 1.0)
    return sim, cockpit


START_PATIENCE = 30.0
"""Longest time in which the page's process starts [s]."""
END_PATIENCE = 10.0
"""Longest time in which it ends once its line is closed [s]."""


def _end(link: Link, process: subprocess.Popen[bytes]) -> None:
    link.close()
    process.wait(END_PATIENCE)
