"""A user's own parts on the command line: ``--with FILE.py``.

The file defines any of ``controller``, ``behaviors``, ``world`` and ``extend``, which
are arguments of ``AtlasSimulation``.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from atlas_drake.errors import ScenarioError

OPTION = "--with"


def add_parts_option(parser: argparse._ActionsContainer) -> None:
    """Adds the option to a command."""
    parser.add_argument(
        OPTION,
        dest="parts",
        type=Path,
        metavar="FILE.py",
        help="put in parts of your own: those of controller, behaviors, world, extend "
        "that the file defines, as AtlasSimulation takes them",
    )


def load_parts(path: Path | None) -> dict[str, Any]:
    """Runs a file, if there is one; returns arguments of ``AtlasSimulation``.

    Raises:
        ScenarioError: If the file fails, or defines no part.
    """
    if path is None:
        return {}
    # Loads Drake, which the command line's help does without.
    from atlas_drake.simulation.parts_file import PARTS, parts_in, run_file

    parts = parts_in(run_file(path, OPTION))
    if not parts:
        raise ScenarioError(
            OPTION, str(path), f"{path} defines none of {', '.join(PARTS)}"
        )
    return parts
