"""Logs on the command line: draw a page of figures, watch a replay.

Figures are in ``logs``, the replay in ``diagrams.replay``; options are parsed in
``main``.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

from pydrake.systems.analysis import Simulator

from atlas_drake.app import exit_status
from atlas_drake.app.interrupts import ctrl_c, nothing_cut_off
from atlas_drake.app.outputs import (
    check_outputs,
    check_writable,
    invite_viewer,
    keep,
    keep_recording,
    open_view,
    quiet_logs,
    realtime_rate,
    shown_of_log,
)
from atlas_drake.app.progress import Progress, StatusLine
from atlas_drake.app.run import PIECE
from atlas_drake.atomic_write import atomic_write
from atlas_drake.diagrams.replay import make_replay
from atlas_drake.errors import did_you_mean
from atlas_drake.logs import Log, LogError, read_log
from atlas_drake.logs.figures import make_page
from atlas_drake.logs.header import (
    PLOT_EXTRA,
    MissingPackageError,
    missing_package,
)
from atlas_drake.logs.panels import Page
from atlas_drake.simulation.pace import Pace
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import interactive, keep_serving

PICTURES = (".png", ".html")
"""Endings of the files of ``plot``: a picture, and an interactive page."""
FIGURES = ".figures"
"""Part of a default file name before these endings: ``run.html`` may be the recording
of the run that ``run.mcap`` logs."""


def plot_log(options: argparse.Namespace) -> int:
    """Draws the figures of a log; returns the exit status.

    Raises:
        LogError: If the log cannot be read or a file cannot be made.
        ScenarioError: If a file cannot be written; raised before any is written.
    """
    files = options.output or [
        options.log.with_suffix(FIGURES + ending) for ending in PICTURES
    ]
    for file in files:
        check_writable("--output", file)
    drawings, missing = {}, []
    for file in files:
        try:
            drawings[file] = _drawing(file)
        except MissingPackageError as error:
            # Without a request the default is every format whose package is installed.
            if options.output:
                raise
            missing.append(error)
    progress = Progress(sys.stdout, math.inf)
    for absent in missing:
        progress.say(f"Left out: {absent}")
    if not drawings:
        raise missing[0]
    try:
        page = make_page(_read(options.log))
    except KeyError as error:
        raise LogError(f"{options.log}: {error.args[0]}") from error
    kept = True
    for file, draw in drawings.items():
        progress.say(f"Drawing {file} ...")
        kept = keep(file, partial(_draw, draw, page, file), progress) and kept
    return exit_status.OK if kept else exit_status.OUTPUT_LOST


def _draw(draw: Callable[[Page, Path], None], page: Page, file: Path) -> None:
    with atomic_write(file) as unfinished:
        draw(page, unfinished)


def _drawing(file: Path) -> Callable[[Page, Path], None]:
    """Returns the function that draws a file of that kind."""
    try:
        if file.suffix == ".png":
            from atlas_drake.logs.png_page import write_png

            return write_png
        if file.suffix == ".html":
            from atlas_drake.logs.html_page import write_html

            return write_html
    except ModuleNotFoundError as error:
        raise missing_package(f"{file}: drawing it", error.name, PLOT_EXTRA) from None
    hint = did_you_mean(file.suffix, PICTURES)
    raise LogError(f"{file}: figures must end in one of {', '.join(PICTURES)}.{hint}")


def replay_log(options: argparse.Namespace) -> int:
    """Plays a log in the 3D view, or records it; returns the exit status.

    Raises:
        LogError: If the log cannot be read, or there is nothing to do.
        ScenarioError: If a file or an address cannot be used; raised before the replay.
    """
    if options.headless and options.record is None:
        raise LogError(
            "--headless shows nothing: add --record FILE.html, or leave it out to watch"
        )
    check_outputs(options, ("record",))
    if options.cockpit:
        return _replay_in_cockpit(options)
    if options.beside is not None:
        raise LogError("--beside needs --cockpit, which shows two logs at a time")
    quiet_logs()
    log = _read(options.log)
    begin, end = float(log.time[0]), float(log.time[-1])
    progress = Progress(sys.stdout, end)
    meshcat = open_view(options, progress)
    diagram = make_replay(
        log,
        meshcat,
        Overlays(
            shown_of_log(options.show, log, progress),
            recorded=options.record is not None,
        ),
    )
    simulator = Simulator(diagram)
    simulator.get_mutable_context().SetTime(begin)
    simulator.Initialize()
    invite_viewer(meshcat, options, progress)
    pace = Pace(simulator)
    pace.set_rate(realtime_rate(options))
    with nothing_cut_off():
        interrupted = _play(log, simulator, pace, end, progress)
        now = simulator.get_context().get_time()
        progress.say(f"{'Stopped' if interrupted else 'Replayed'} at {now:.1f} s.")
        kept = keep_recording(meshcat, options, progress)
    if interrupted:
        return exit_status.INTERRUPTED
    if not kept:
        return exit_status.OUTPUT_LOST
    if not options.headless and interactive():
        keep_serving(progress.say)
    return exit_status.OK


def _replay_in_cockpit(options: argparse.Namespace) -> int:
    """Serves the cockpit over a log until Ctrl-C; returns the exit status."""
    from atlas_drake.app.cockpit_replay import play_in_cockpit

    if options.record is not None or options.headless:
        option = "--headless" if options.record is None else "--record"
        raise LogError(f"{option} cannot be used with --cockpit")
    log = _read(options.log)
    beside = None if options.beside is None else _read(options.beside)
    return play_in_cockpit(log, beside, options)


def _play(
    log: Log, simulator: Simulator, pace: Pace, end: float, progress: Progress
) -> bool:
    """Plays to the end; returns True if Ctrl-C came first."""
    events = iter(log.events)
    event = next(events, None)
    with ctrl_c() as asked_to_stop:
        while (now := simulator.get_context().get_time()) < end - 1e-9:
            if asked_to_stop.is_set():
                return True
            now = min(now + PIECE, end)
            pace.forget_lost_time()
            simulator.AdvanceTo(now)
            while event is not None and event.time <= now:
                progress.event(event)
                event = next(events, None)
            row = min(int(log.time.searchsorted(now)), len(log) - 1)
            progress.update(now, log.behavior(int(log["behavior.current"][row])).name)
        return asked_to_stop.is_set()


def _read(path: Path) -> Log:
    StatusLine(sys.stdout).say(f"Reading {path} ...")
    return read_log(path)
