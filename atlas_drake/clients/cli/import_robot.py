"""``atlas-drake import``: makes a robot of a URDF, and tries it."""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.outputs import quiet_logs
from atlas_drake.clients.cli.progress import StatusLine
from atlas_drake.clients.film.file import FilmError
from atlas_drake.errors import AtlasError

if TYPE_CHECKING:
    from atlas_drake.clients.importing.findings import Findings
    from atlas_drake.robot import Robot


def run_import(options: argparse.Namespace) -> int:
    """Imports a robot; returns the exit status."""
    progress = StatusLine(sys.stdout)
    progress.show("Loading ...")
    quiet_logs()
    try:
        from atlas_drake.clients.importing.importer import import_robot
        from atlas_drake.clients.importing.options import ImportOptions
    except ImportError as error:
        raise AtlasError(
            f'an import needs {error.name}: pip install "atlas-drake[import]"'
        ) from None
    from atlas_drake.clients.importing.findings import Findings
    from atlas_drake.clients.importing.source import find_source

    source = find_source(options.robot)
    chosen = ImportOptions(
        packages=dict(options.package),
        faces=options.faces,
        feet=options.feet and tuple(options.feet),
        chest=options.chest,
        hands=options.hands and tuple(options.hands),
        sole=options.sole and tuple(options.sole),
        fixed=tuple(options.fix),
        fingers=options.fingers,
    )
    folder: Path = options.out or Path(re.sub(r"[^\w-]+", "_", source.stem))
    progress.say(f"{source}")
    findings = Findings(progress.say)
    progress.show("Reading links, joints and meshes ...")
    try:
        robot = import_robot(source, folder.absolute(), chosen, findings)
    except OSError as error:
        progress.say(f"! {error.filename}: {error.strerror}")
        return exit_status.OUTPUT_LOST
    progress.say(f"Wrote {folder}/robot.yaml")
    if options.no_trial:
        return exit_status.OK
    return _try(robot, folder, findings, progress)


def _try(robot: Robot, folder: Path, findings: Findings, progress: StatusLine) -> int:
    """Lets the robot stand, walk and be pushed, and writes the report."""
    from atlas_drake.clients.importing.files import PAGE, PICTURE
    from atlas_drake.clients.importing.report import results, write_page, write_picture
    from atlas_drake.clients.importing.trial import try_robot

    def say(what: str) -> None:
        progress.show(f"Trying: {what} ...")

    with tempfile.TemporaryDirectory() as temporary:
        log = Path(temporary) / "trial.mcap"
        try:
            trial = try_robot(robot.path, log, say)
        except KeyboardInterrupt:
            progress.say(f"Interrupted: {folder}/robot.yaml is whole, but not tried")
            raise
        for name, value in results(trial):
            progress.say(f"{name}: {value}")
        progress.show("Drawing ...")
        write_page(trial, robot, findings, folder / PAGE)
        try:
            write_picture(log, trial, robot, folder / PICTURE)
        except FilmError as error:
            progress.say(f"! there is no picture: {error}")
    progress.say(f"Wrote the report: {folder / PAGE}")
    progress.say(f"Try it: atlas-drake teleop --model {folder}/robot.yaml")
    done = trial.stands and trial.walks
    return exit_status.OK if done else exit_status.FAILED
