"""Logs on the command line: draw figures, export a table, watch or film a replay.

Figures are in ``logs``, the replay in ``film.replay``; options are parsed in
``main``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pydrake.systems.analysis import Simulator

from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.interrupts import ctrl_c, nothing_cut_off
from atlas_drake.clients.cli.outputs import (
    check_outputs,
    check_writable,
    invite_viewer,
    keep_file,
    keep_recording,
    open_view,
    quiet_logs,
    read_saying,
    realtime_rate,
    shown_of_log,
    wants_cockpit,
)
from atlas_drake.clients.cli.progress import Progress, StatusLine
from atlas_drake.clients.cli.run import PIECE
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.clients.logs import Log, LogError, read_log
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import interactive, keep_serving
from atlas_drake.errors import did_you_mean
from atlas_drake.simulation.pace import Pace

TABLES = (".parquet", ".csv", ".npz")
"""Endings of the files of ``export``; the first is the default."""


def plot_log(options: argparse.Namespace) -> int:
    """Draws the figures of a log, or lists its columns; returns the exit status."""
    progress = StatusLine(sys.stdout)
    if options.channels == "":
        log = read_log(options.log)
        for name, unit in log.units.items():
            progress.say(f"{name} [{unit or '-'}]")
        return exit_status.OK
    with _needs_extra("plot"):
        from atlas_drake.clients.logs.figures import SUFFIXES, draw_channels, draw_page
    file = _output(options, SUFFIXES)
    log = read_saying(options.log, progress)
    if options.channels is None:
        figure = draw_page(log)
    else:
        figure = draw_channels(log, options.channels.split(","))
    return _write(file, figure.savefig)


def export_log(options: argparse.Namespace) -> int:
    """Writes the columns of a log as a table; returns the exit status."""
    file = _output(options, TABLES)
    with _needs_extra("export"):
        log = read_saying(options.log, StatusLine(sys.stdout))
        if file.suffix == ".npz":
            return _write(file, log.to_npz)
        table = log.to_pandas()
        if file.suffix == ".csv":
            return _write(file, table.to_csv)
        return _write(file, table.to_parquet)


def _output(options: argparse.Namespace, suffixes: Sequence[str]) -> Path:
    """Returns the file to write, by default beside the log with the first suffix."""
    file: Path = options.output or options.log.with_suffix(suffixes[0])
    if file.suffix not in suffixes:
        hint = did_you_mean(file.suffix, suffixes)
        raise LogError(f"{file}: must end in one of {', '.join(suffixes)}.{hint}")
    check_writable("--output", file)
    return file


def _write(file: Path, write: Callable[[Path], object]) -> int:
    """Writes a file, whole or not at all; returns the exit status."""
    kept = keep_file(file, write, StatusLine(sys.stdout))
    return exit_status.OK if kept else exit_status.OUTPUT_LOST


@contextmanager
def _needs_extra(extra: str) -> Iterator[None]:
    """Turns a package that is not installed into one line about how to install it."""
    try:
        yield
    except ImportError:
        raise LogError(
            f'packages are missing: pip install "atlas-drake[{extra}]"'
        ) from None


def replay_log(options: argparse.Namespace) -> int:
    """Plays a log in the 3D view, or records it; returns the exit status."""
    if options.headless and options.record is None:
        raise LogError(
            "--headless shows nothing: add --record FILE.html, or leave it out to watch"
        )
    check_outputs(options, ("record",))
    if options.cockpit and options.record is not None:
        raise LogError("--record cannot be used with --cockpit")
    if options.record is None and wants_cockpit(options):
        from atlas_drake.clients.cli.teleop import play_in_cockpit

        progress, beside = StatusLine(sys.stdout), None
        if options.beside is not None:
            beside = read_saying(options.beside, progress)
        log = read_saying(options.log, progress)
        return play_in_cockpit(log, beside, options)
    if options.beside is not None:
        raise LogError("--beside needs the cockpit, which shows two logs at a time")
    quiet_logs()
    log = read_saying(options.log, StatusLine(sys.stdout))
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
