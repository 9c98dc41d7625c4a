"""One run on the command line: watch it, record it, save it, judge it.

The simulation itself is ``AtlasSimulation``; options are parsed in ``main``.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

from atlas_drake.clients import session
from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.film import film_run, log_for_film, with_logged_overlays
from atlas_drake.clients.cli.interrupts import ctrl_c, nothing_cut_off
from atlas_drake.clients.cli.outputs import (
    check_outputs,
    cockpit_asked_for,
    invite_viewer,
    keep_file,
    keep_log,
    keep_recording,
    open_view,
    quiet_logs,
    realtime_rate,
)
from atlas_drake.clients.cli.policy import policy_settings
from atlas_drake.clients.cli.progress import Progress
from atlas_drake.clients.film.file import check_film
from atlas_drake.clients.parts_file import load_parts
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import interactive, keep_serving
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.messages.footstep import is_elsewhere
from atlas_drake.scenario import Scenario, load_scenario, with_settings
from atlas_drake.simulation import AtlasSimulation, SimulationError
from atlas_drake.simulation.tutorial import DURATION

if TYPE_CHECKING:
    from atlas_drake.clients.cockpit.cockpit import Cockpit

PIECE = 0.1
"""Simulated time between updates of the progress line [s]."""
CLOSED_FOR = 5.0
"""Wall time without an open page after which nobody looks any more [s]."""
AFTER_FALL = 2.0
"""Time after a fall at which the run ends [s]."""

Simulate: TypeAlias = Callable[[AtlasSimulation, Progress, threading.Event], str | None]
"""Simulates a run until its end, or until Ctrl-C sets the event; returns None, or why
it ended early, other than by a fall or Ctrl-C."""


def run_demo(options: argparse.Namespace) -> int:
    """Runs the tutorial; returns the exit status."""
    scenario = Scenario(
        name="demo",
        schedule="tutorial_literal" if options.literal else "tutorial",
        duration=DURATION,
    )
    return run_scenario(scenario, options)


def run_file(options: argparse.Namespace) -> int:
    """Runs the scenario of a file; returns the exit status."""
    return run_scenario(scenario_of(options, "run"), options)


def scenario_of(options: argparse.Namespace, name: str) -> Scenario:
    """Reads a command's scenario; without a file it is the default of this name."""
    path = options.scenario
    if path is None:
        return Scenario(name=name)
    try:
        return load_scenario(path)
    except ScenarioError as error:
        from atlas_drake.clients.campaigns.reading import is_campaign

        if error.field == "file" or not is_campaign(path):
            raise
        problem = f"{path} is a campaign: use `atlas-drake sweep {path}`"
        raise ScenarioError(error.field, error.value, problem) from None


def run_scenario(
    scenario: Scenario,
    options: argparse.Namespace,
    simulate: Simulate | None = None,
    end: float | None = None,
    may_interrupt: Callable[[], bool] = lambda: False,
) -> int:
    """Runs a scenario with the options of the command line; returns the exit status.

    ``simulate`` runs it until ``end`` [s], infinite if unknown; without them it lasts
    for the scenario's duration. Ctrl-C interrupts at once if ``may_interrupt``.
    """
    scenario = with_logged_overlays(with_options(scenario, options), options)
    check_outputs(options, ("json", "record", "video", "log"))
    if options.video is not None:
        check_film(options.video, options.video_size)
    quiet_logs()

    parts = load_parts(options.parts)
    progress = Progress(sys.stdout, scenario.duration if end is None else end)
    overlays = Overlays(options.show, recorded=options.record is not None)
    cockpit = cockpit_asked_for(options, overlays)
    meshcat = open_view(options, progress, cockpit)
    filmed = exit_status.OK
    with log_for_film(options) as log:
        sim = session.AtlasSimulation(
            scenario,
            view=meshcat,
            listeners=[progress],
            overlays=overlays,
            log=log,
            **parts,
        )
        if cockpit is not None:
            cockpit.join(sim)
        invite_viewer(cockpit or meshcat, options, progress)
        if options.realtime_rate is not None or not sim.realtime_rate:
            sim.set_realtime_rate(realtime_rate(options))

        with nothing_cut_off():
            try:
                with ctrl_c(may_interrupt) as asked_to_stop:
                    if cockpit is not None:  # Ctrl-C ends a pause there.
                        cockpit.asked_to_stop = asked_to_stop.is_set
                    stopped = (simulate or _simulate)(sim, progress, asked_to_stop)
                    if asked_to_stop.is_set():
                        stopped = INTERRUPTED
            finally:
                # Also after a second Ctrl-C: unfinished files cannot be read.
                kept = keep_log(sim, options, progress)
            summary = sim.summary()
            summary["stopped"] = stopped
            if stopped is not None:
                summary["success"] = False
            progress.say(verdict(summary))
            if cockpit is not None:
                cockpit.say(verdict(summary))
            if options.json is not None:
                text = json.dumps(_plain(summary), indent=2) + "\n"
                kept &= keep_file(
                    options.json,
                    lambda file: file.write_text(text, encoding="utf-8"),
                    progress,
                )
            kept = keep_recording(meshcat, options, progress) and kept
        if options.video is not None and log is not None:
            filmed = film_run(log, options, progress, parts.get("world", ()))
    if stopped == INTERRUPTED or filmed == exit_status.INTERRUPTED:
        return exit_status.INTERRUPTED
    if not kept or filmed != exit_status.OK:
        return exit_status.OUTPUT_LOST
    if cockpit is not None:
        go_on_in_page(sim, cockpit, progress)
    elif not options.headless and interactive():
        keep_serving(progress.say)
    return exit_status.OK if summary["success"] else exit_status.FAILED


def go_on_in_page(sim: AtlasSimulation, cockpit: Cockpit, progress: Progress) -> None:
    """Goes on while somebody has the page open, until Ctrl-C."""
    if not cockpit.GetNumActiveConnections():
        return
    progress.say("The run goes on in the page until you close it, or press Ctrl-C.")
    seen = time.monotonic()
    with ctrl_c() as asked_to_stop, suppress(SimulationError):
        cockpit.asked_to_stop = asked_to_stop.is_set
        while not asked_to_stop.is_set() and time.monotonic() < seen + CLOSED_FOR:
            sim.advance(PIECE)
            if cockpit.GetNumActiveConnections():
                seen = time.monotonic()


def with_options(scenario: Scenario, options: argparse.Namespace) -> Scenario:
    """Returns a scenario with the options of the command line; ``--set`` comes last."""
    names = ("model", "world", "seed", "physics_step", "duration")
    given = {name: getattr(options, name) for name in names}
    changes = {name: value for name, value in given.items() if value is not None}
    settings = [*policy_settings(options), *options.set]
    return with_settings(replace(scenario, **changes), settings)


INTERRUPTED = "interrupted"
"""Value of the summary's ``stopped`` after Ctrl-C."""


def _simulate(
    sim: AtlasSimulation, progress: Progress, asked_to_stop: threading.Event
) -> str | None:
    """Advances to the scenario's end; returns the error that ended it earlier."""
    end = sim.scenario.duration
    try:
        while sim.time < end - 1e-9 and not asked_to_stop.is_set():
            sim.advance_to(min(sim.time + PIECE, end))
            progress.update(sim.time, sim.current_behavior.name)
            end = min(end, end_after_fall(sim))
    except SimulationError as error:
        return str(error)
    return None


def end_after_fall(sim: AtlasSimulation) -> float:
    """Returns the time at which a fall ends the run [s]; infinite on its feet.

    A program may have put a robot that fell before back on its feet.
    """
    if not sim.has_fallen:
        return math.inf
    return max(e.time for e in sim.events if e.kind == "fall") + AFTER_FALL


def verdict(summary: dict[str, Any]) -> str:
    """Describes the result of a run in one or two sentences."""
    errors = [step["error_m"] for step in summary["footsteps"]]
    elsewhere = [s["error_m"] for s in summary["footsteps"] if is_elsewhere(s)]
    steps = ""
    if errors:
        steps = f", {len(errors)} steps taken (at most {1e3 * max(errors):.0f} mm off)"
    first = {event["kind"]: event for event in reversed(summary["events"])}
    if summary["stopped"] == INTERRUPTED:
        text = f"Stopped at {summary['sim_time']:.1f} s{steps}."
    elif summary["stopped"] is not None:
        text = f"Failed: {summary['stopped']}."
    elif summary["fell"]:
        fall = first["fall"]
        text = f"Failed: the robot fell at {fall['time']:.1f} s: {fall['text']}."
    elif summary["success"]:
        text = (
            f"Success: the robot is upright after {summary['sim_time']:.1f} s{steps}."
        )
    elif "refusal" in first:
        why = first["refusal"]["text"].removesuffix(".")
        text = f"Failed: the robot is upright, but did not execute a command: {why}."
    elif STEPS_LEFT in first:
        text = f"Failed: the robot is upright, but {first[STEPS_LEFT]['text']}."
    elif elsewhere and summary["upright"]:
        text = (
            f"Failed: the robot is upright, but a foot landed {max(elsewhere):.2f} m "
            "from its commanded place."
        )
    else:
        text = f"Failed: the robot did not end upright{steps}."
    factor = summary["real_time_factor"]
    return text if factor is None else f"{text} Ran at {factor:.2f} x real time."


def _plain(value: Any) -> Any:
    """Replaces infinities and NaN, which JSON does not have."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
