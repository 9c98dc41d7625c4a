"""Python files of a user that bring parts of a simulation, or functions.

Runs the files and takes what they define.
"""

from __future__ import annotations

import runpy
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.errors import AtlasError, ScenarioError

PARTS = ("controller", "behaviors", "world", "extend")
"""Names that a file may define, those of arguments of ``AtlasSimulation``."""


def run_file(path: Path, option: str) -> dict[str, Any]:
    """Runs a file and returns all that it defines.

    Modules beside the file can be imported by it. Its ``__name__`` is not
    ``"__main__"``, so that a program's own run does not begin.
    """
    if problem := why_not_readable(path):
        raise ScenarioError(option, str(path), f"{path}: {problem}")
    folder = str(path.resolve().parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        return runpy.run_path(str(path), run_name="atlas_drake_parts")
    except AtlasError:
        raise
    except (Exception, SystemExit) as error:
        raise ScenarioError(
            option, str(path), f"{path} failed: {type(error).__name__}: {error}"
        ) from error


def parts_in(names: Mapping[str, Any]) -> dict[str, Any]:
    """The parts among what a file defines: arguments of ``AtlasSimulation``."""
    return {name: names[name] for name in PARTS if name in names}


def load_parts(path: Path | None) -> dict[str, Any]:
    """Returns the parts in the file of ``--with``, if there is one."""
    if path is None:
        return {}
    parts = parts_in(run_file(path, "--with"))
    if not parts:
        problem = f"{path} defines none of {', '.join(PARTS)}"
        raise ScenarioError("--with", str(path), problem)
    return parts
