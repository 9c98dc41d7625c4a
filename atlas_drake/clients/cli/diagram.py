"""``atlas-drake diagram``: a picture of the simulation's block diagram, by Drake."""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.progress import StatusLine
from atlas_drake.errors import AtlasError
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation

FORMATS = (".svg", ".png", ".pdf", ".dot")


def show_diagram(options: argparse.Namespace) -> int:
    """Draws the whole simulation into a file, whose ending selects the format."""
    path: Path = options.file
    if path.suffix not in FORMATS:
        raise AtlasError(f"{path}: must end in one of {', '.join(FORMATS)}")
    dot = shutil.which("dot")
    if path.suffix != ".dot" and dot is None:
        raise AtlasError(
            f"{path}: drawing it needs Graphviz, which is not installed: "
            "apt install graphviz, brew install graphviz or https://graphviz.org; or "
            f"ask for {path.with_suffix('.dot')}, which any Graphviz viewer draws"
        )
    simulation = AtlasSimulation(Scenario(schedule="tutorial"))
    source = simulation.diagram.GetGraphvizString()
    try:
        if path.suffix == ".dot":
            path.write_text(source)
        else:
            command = [str(dot), f"-T{path.suffix[1:]}", "-o", str(path)]
            subprocess.run(
                command, input=source, text=True, check=True, capture_output=True
            )
    except OSError as error:
        raise AtlasError(f"{path}: cannot be written: {error.strerror}") from error
    except subprocess.CalledProcessError as error:
        raise AtlasError(f"{path}: {error.stderr.strip()}") from error
    StatusLine(sys.stdout).say(f"Wrote {path}.")
    return exit_status.OK
