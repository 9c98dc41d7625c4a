"""Common command line of the benchmarks: versions and `--json`.

Independent of the measured quantities.
"""

from __future__ import annotations

import argparse
import json
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any


def versions() -> dict[str, str]:
    """Returns the versions that figures depend on, by name."""
    return {"drake": version("drake"), "python": platform.python_version()}


def command_line(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Adds `--json`, reads the command line, and prints the versions."""
    parser.add_argument("--json", type=Path, metavar="FILE", help="write figures here")
    options = parser.parse_args()
    found = versions()
    print(f"Drake {found['drake']}, Python {found['python']}", flush=True)
    return options


def write_figures(path: Path | None, figures: dict[str, Any]) -> None:
    """Writes versions and figures as JSON, if a file is asked for."""
    if path is not None:
        result = {"versions": versions(), **figures}
        path.write_text(json.dumps(result, indent=2) + "\n")
