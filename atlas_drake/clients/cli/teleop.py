"""The cockpit over a simulation, ``teleop``, or over a log, ``replay --cockpit``."""

from __future__ import annotations

import argparse
import math
import sys
import threading
import time
from collections.abc import Callable

from pydrake.math import RigidTransform

from atlas_drake.clients import session
from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.interrupts import ctrl_c
from atlas_drake.clients.cli.outputs import quiet_logs, shown_of_log
from atlas_drake.clients.cli.progress import Progress
from atlas_drake.clients.cli.run import (
    INTERRUPTED,
    PIECE,
    scenario_of,
    verdict,
    with_options,
)
from atlas_drake.clients.cockpit.cockpit import Cockpit
from atlas_drake.clients.cockpit.log_page import LogPage
from atlas_drake.clients.film.replay import make_replay, make_replay_beside
from atlas_drake.clients.logs import Log
from atlas_drake.clients.parts_file import load_parts
from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import interactive, open_on_desktop
from atlas_drake.errors import AtlasError
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation, SimulationError

BESIDE_PATH = "/atlas_drake/beside"
"""Where the 3D view has the robot of the second log."""
ASIDE = 1.5
"""How far to the left of its own place the robot of the second log is drawn [m]."""


def run_teleop(options: argparse.Namespace) -> int:
    """Runs until Ctrl-C, or for ``options.duration`` [s]; returns the exit status."""
    scenario = with_options(scenario_of(options, "teleop"), options)
    quiet_logs()
    end = math.inf if options.duration is None else options.duration
    progress = Progress(sys.stdout, end)
    cockpit = Cockpit(options.host, options.port, Overlays(options.show))
    cockpit.next_run.why_not = ""

    def build(scenario: Scenario, cockpit: Cockpit | None) -> AtlasSimulation:
        arguments = load_parts(options.parts)
        if cockpit is not None:
            arguments |= {"view": cockpit.meshcat, "overlays": cockpit.overlays}
        sim = session.AtlasSimulation(scenario, listeners=[progress], **arguments)
        if cockpit is not None:
            cockpit.join(sim)
        return sim

    sim = build(scenario, cockpit)
    sim.set_realtime_rate(1.0)
    with ctrl_c() as asked_to_stop:
        cockpit.asked_to_stop = asked_to_stop.is_set
        _invite(cockpit, "Steer", progress)
        failure = _steer(sim, cockpit, progress, end, asked_to_stop)
        while (asked := cockpit.next_run.take()) is not None:
            sim = followed(sim, asked, build, cockpit, progress)
            failure = _steer(sim, cockpit, progress, end, asked_to_stop)
    summary = sim.summary()
    # Teleoperation has no goal to judge; only an error counts as a failure.
    summary["stopped"] = failure or INTERRUPTED
    progress.say(verdict(summary))
    return exit_status.OK if failure is None else exit_status.FAILED


def followed(
    sim: AtlasSimulation,
    asked: Scenario,
    build: Callable[[Scenario, Cockpit | None], AtlasSimulation],
    cockpit: Cockpit,
    progress: Progress,
) -> AtlasSimulation:
    """Returns the simulation of another scenario, or the present one if it fails.

    It is tried without a view first: until it is certain, nothing is lost of what is
    seen.
    """
    cockpit.say(f"Building {asked.name} ...")
    try:
        build(asked, None)
    except AtlasError as error:
        problem = f"{asked.name} cannot be simulated: {error}"
        progress.say(f"! {problem}")
        cockpit.say(problem, lasting=True)
        return sim
    for drawn in ("/drake", "/atlas_drake"):
        cockpit.meshcat.Delete(drawn)
    following = build(asked, cockpit)
    following.set_realtime_rate(sim.realtime_rate)
    return following


def _steer(
    sim: AtlasSimulation,
    cockpit: Cockpit,
    progress: Progress,
    end: float,
    asked_to_stop: threading.Event,
) -> str | None:
    """Runs until the end, Ctrl-C or another scenario; returns the error, if any."""
    try:
        while sim.time < end - 1e-9 and not asked_to_stop.is_set():
            if cockpit.next_run.scenario is not None:
                return None
            sim.advance_to(min(sim.time + PIECE, end))
            progress.update(sim.time, sim.current_behavior.name)
    except SimulationError as error:
        return str(error)
    return None


def play_in_cockpit(log: Log, beside: Log | None, options: argparse.Namespace) -> int:
    """Shows a log, and one beside it, until Ctrl-C; returns the exit status.

    Where nobody is at the terminal and nobody opens the page, the log ends it.
    """
    quiet_logs()
    progress = Progress(sys.stdout, math.inf)
    overlays = Overlays(shown_of_log(options.show, log, progress))
    cockpit = Cockpit(options.host, options.port, overlays)
    diagrams = [make_replay(log, cockpit.meshcat, overlays)]
    if beside is not None:
        diagrams.append(make_replay_beside(beside, cockpit.meshcat, BESIDE_PATH))
    page = LogPage(log, diagrams, cockpit.meshcat, overlays, beside)
    # The begin of the playback has drawn everything anew.
    cockpit.meshcat.SetTransform(BESIDE_PATH, RigidTransform([0.0, ASIDE, 0.0]))
    if options.realtime_rate is not None:
        page.rate(options.realtime_rate)
    cockpit.present(page)
    with ctrl_c() as asked_to_stop:
        _invite(cockpit, "Watch", progress)
        waits = bool(options.cockpit) or interactive()
        before = time.perf_counter()
        while not asked_to_stop.wait(1.0 / FRAME_RATE):
            now = time.perf_counter()
            is_watched = cockpit.GetNumActiveConnections() > 0
            if is_watched or not waits:  # Else a log does not play to nobody.
                page.advance(now - before)
            cockpit.look()
            before = now
            if not (is_watched or waits) and page.is_over:
                progress.say(f"Replayed at {page.time:.1f} s.")
                return exit_status.OK
    return exit_status.INTERRUPTED if not waits else exit_status.OK


def _invite(cockpit: Cockpit, verb: str, progress: Progress) -> None:
    progress.say(f"{verb} at {cockpit.web_url()} (Ctrl-C here ends it).")
    if interactive():
        open_on_desktop(cockpit.web_url())
