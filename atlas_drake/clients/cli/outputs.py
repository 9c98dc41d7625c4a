"""Outputs of the command line: 3D view, recording, text files.

The same for a run and for the replay of its log. Serving the view is in ``viewer``.
"""

from __future__ import annotations

import argparse
import logging
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from pydrake.geometry import Meshcat

from atlas_drake.atomic_write import atomic_write, why_not_writable
from atlas_drake.clients.cli.progress import Progress, StatusLine
from atlas_drake.clients.logs import Log, read_log
from atlas_drake.clients.logs.mcap_writer import check_log_path
from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.clients.view.overlays import LOG_FIELDS, OVERLAYS, logged_overlays
from atlas_drake.clients.view.viewer import Served, await_viewer, start_meshcat
from atlas_drake.errors import AtlasError, ScenarioError

if TYPE_CHECKING:
    from atlas_drake.clients.cockpit.cockpit import Cockpit
    from atlas_drake.clients.view.overlays import Overlays
    from atlas_drake.simulation import AtlasSimulation

WEB_PAGES = (".html", ".htm")
"""Endings of a recording's name."""


def check_outputs(options: argparse.Namespace, names: Collection[str]) -> None:
    """Checks, before the run, that the files of these options can be written.

    Refuses a file that is named twice, or that is read.
    """
    taken = {}
    for name in ("scenario", "log"):
        read = getattr(options, name, None)
        if read is not None and name not in names:
            taken[read.resolve()] = f"the file of the {name}"
    for name in names:
        path = getattr(options, name)
        if path is None:
            continue
        option = f"--{name}"
        check_writable(option, path)
        if name == "record" and path.suffix not in WEB_PAGES:
            raise ScenarioError(
                option, str(path), f"{path} must end in .html: it is a web page"
            )
        if name == "log":
            check_log_path(path)
        before = taken.setdefault(path.resolve(), option)
        if before != option:
            raise ScenarioError(option, str(path), f"{path} is already {before}")


def keep(
    path: Path,
    write: Callable[[], object],
    progress: StatusLine,
    use: str = "",
) -> bool:
    """Writes a file, and says how to ``use`` it; returns True on success.

    A file that cannot be written does not affect the others.
    """
    try:
        write()
    except (OSError, AtlasError) as error:
        problem = getattr(error, "strerror", None) or str(error)
        for known in (f"{path}: ", "cannot be written: "):
            problem = problem.removeprefix(known)
        progress.say(f"! {path} is lost: {problem}")
        return False
    progress.say(f"Wrote {path}.{use}")
    return True


def keep_file(
    path: Path, write: Callable[[Path], object], progress: StatusLine, use: str = ""
) -> bool:
    """Writes a file, as ``keep`` does, whole or not at all."""

    def whole() -> None:
        with atomic_write(path) as unfinished:
            write(unfinished)

    return keep(path, whole, progress, use)


def keep_log(
    sim: AtlasSimulation, options: argparse.Namespace, progress: Progress
) -> bool:
    """Completes the log of a run; returns True on success."""
    if options.log is None:
        with suppress(AtlasError):  # Of a film alone, which shows what there is.
            sim.close()
        return True
    if sim.time == 0.0:
        sim.close()
        progress.say(f"{options.log} is not written: nothing was simulated.")
        return True
    progress.say(f"Completing {options.log} ...")
    use = f" Draw it: atlas-drake plot {options.log}"
    return keep(options.log, sim.close, progress, use)


def check_writable(option: str, path: Path) -> None:
    """Raises a ScenarioError if no file can be written there."""
    problem = why_not_writable(path)
    if problem is not None:
        raise ScenarioError(option, str(path), problem)


def cockpit_asked_for(
    options: argparse.Namespace, overlays: Overlays
) -> Cockpit | None:
    """Serves the cockpit, if it is asked for, or where it is usual and installed."""
    if not wants_cockpit(options):
        return None
    from atlas_drake.clients.cockpit.cockpit import Cockpit

    return Cockpit(options.host, options.port, overlays)


def wants_cockpit(options: argparse.Namespace) -> bool:
    """Returns True if the cockpit is to be opened.

    Raises ScenarioError if it is asked for together with --headless.
    """
    if options.cockpit and options.headless:
        raise ScenarioError("--cockpit", True, "cannot be used with --headless")
    if options.cockpit is not None or options.headless or not options.cockpit_is_usual:
        return bool(options.cockpit)
    from atlas_drake.clients.cockpit.cockpit import is_installed

    return is_installed()


def open_view(
    options: argparse.Namespace, progress: Progress, cockpit: Cockpit | None = None
) -> Meshcat | None:
    """Serves a 3D view if it is watched or recorded.

    Call it before the diagram is built, whose first picture belongs to the recording.
    """
    if options.headless and options.record is None:
        return None
    if cockpit is None:
        meshcat = start_meshcat(options.host, options.port, progress.say)
    else:
        meshcat = cockpit.meshcat
    if options.record is not None:
        meshcat.StartRecording(
            frames_per_second=FRAME_RATE,
            set_visualizations_while_recording=not options.headless,
        )
    return meshcat


def invite_viewer(
    page: Served | None, options: argparse.Namespace, progress: Progress
) -> None:
    """Prints the address of a page, and gives a browser the time to open."""
    if page is not None and not options.headless:
        await_viewer(page, progress.say)


def realtime_rate(options: argparse.Namespace) -> float:
    """Simulated seconds per second, at most; 0 is as fast as possible."""
    if options.realtime_rate is not None:
        return float(options.realtime_rate)
    return 0.0 if options.headless else 1.0


def keep_recording(
    meshcat: Meshcat | None, options: argparse.Namespace, progress: Progress
) -> bool:
    """Writes the recording, if one is requested; returns True on success."""
    if meshcat is None or options.record is None:
        return True
    meshcat.StopRecording()
    meshcat.PublishRecording()
    page = meshcat.StaticHtml()
    return keep_file(
        options.record,
        lambda file: file.write_text(page, encoding="utf-8"),
        progress,
        " Open it in a browser.",
    )


def read_saying(path: Path, progress: StatusLine) -> Log:
    """Reads a log, and says what is damaged in its header."""
    progress.say(f"Reading {path} ...")
    log = read_log(path)
    for fault in log.header.faults():
        progress.say(f"! {fault}")
    return log


def shown_of_log(names: Iterable[str], log: Log, progress: StatusLine) -> list[str]:
    """Returns the overlays that a log can show, and tells the user about the others."""
    logged = logged_overlays(log.scenario.log)
    for name in names:
        if name not in logged:
            progress.say(
                f"Not shown: {name} ({OVERLAYS[name]}): this log was recorded without; "
                f"record the run with --set log.{LOG_FIELDS[name]}=true"
            )
    return [name for name in names if name in logged]


def quiet_logs() -> None:
    """Silences log messages that repeat the run's own lines or are irrelevant."""
    # Refusals are events, which are printed with the others. A logger without any
    # handler would still print to standard error.
    ours = logging.getLogger("atlas_drake")
    ours.propagate = False
    ours.addHandler(logging.NullHandler())
    # The address of the 3D view is printed separately.
    logging.getLogger("drake").setLevel(logging.WARNING)
    # An import says itself what it leaves out, in names that can be printed.
    for name in ("trimesh", "yourdfpy"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
