"""Films on the command line: of a log, and of a run by ``--video``.

The film itself is ``atlas_drake.clients.film.film``; options are parsed in ``main``.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.interrupts import ctrl_c
from atlas_drake.clients.cli.outputs import keep, quiet_logs, read_saying, shown_of_log
from atlas_drake.clients.cli.progress import StatusLine
from atlas_drake.clients.film.file import check_film
from atlas_drake.clients.logs import Log, LogError, read_log
from atlas_drake.clients.view.overlays import LOG_FIELDS
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario import Scenario
from atlas_drake.worlds.world import WorldMaker
from atlas_drake.worlds.world_file import View


def film_log(options: argparse.Namespace) -> int:
    """Films a log; returns the exit status."""
    path = options.output or options.log.with_suffix(".mp4")
    if path.resolve() == options.log.resolve():
        raise ScenarioError("--output", str(path), f"{path} is the log")
    check_film(path, options.size)
    view = None
    if options.view is not None:
        view = View(options.view[:3], options.view[3:])
        view.check()
    quiet_logs()
    progress = StatusLine(sys.stdout)
    log = read_saying(options.log, progress)
    _ = log.robot  # Without it the log is at fault, and no film is lost.
    show = shown_of_log(options.show, log, progress)
    return _film(log, path, progress, size=options.size, show=show, view=view)


@contextmanager
def log_for_film(options: argparse.Namespace) -> Iterator[Path | None]:
    """Yields where a run is logged: by --log, for --video alone in a temporary file."""
    if options.video is None or options.log is not None:
        yield options.log
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder) / "run.mcap"


def with_logged_overlays(scenario: Scenario, options: argparse.Namespace) -> Scenario:
    """Returns a scenario whose log holds what a film of the run shows."""
    if options.video is None:
        return scenario
    fields = {LOG_FIELDS[name]: True for name in options.show if name in LOG_FIELDS}
    return replace(scenario, log=replace(scenario.log, **fields))


def film_run(
    log: Path,
    options: argparse.Namespace,
    progress: StatusLine,
    world: Sequence[WorldMaker] = (),
) -> int:
    """Films the log of a run into the file of --video; returns an exit status."""
    try:
        records = read_log(log)
    except LogError as error:
        progress.say(f"! {options.video} is lost: {error}")
        return exit_status.OUTPUT_LOST
    return _film(
        records,
        options.video,
        progress,
        size=options.video_size,
        show=shown_of_log(options.show, records, progress),
        world=world,
    )


def _film(log: Log, path: Path, progress: StatusLine, **arguments: Any) -> int:
    """Films a log with progress; Ctrl-C keeps the pictures so far."""
    from atlas_drake.clients.film.film import film

    with ctrl_c() as asked_to_stop:

        def on_picture(now: float) -> None:
            if asked_to_stop.is_set():
                progress.say(f"Stopped: {path} ends at {now:.1f} s.")
                raise KeyboardInterrupt
            progress.show(f"Filming: {now:.1f} of {log.time[-1]:.1f} s")

        try:
            kept = keep(
                path,
                lambda: film(log, path, on_picture=on_picture, **arguments),
                progress,
            )
        except KeyboardInterrupt:
            return exit_status.INTERRUPTED
    return exit_status.OK if kept else exit_status.OUTPUT_LOST
