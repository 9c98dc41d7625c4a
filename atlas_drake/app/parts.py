"""A user's own parts on the command line: ``--with FILE.py``.

The file defines any of ``controller``, ``behaviors``, ``world`` and ``extend``, which
are arguments of ``AtlasSimulation``.
"""

from __future__ import annotations

import argparse
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from atlas_drake.errors import AtlasError, ScenarioError

OPTION = "--with"
PARTS = ("controller", "behaviors", "world", "extend")
"""Names that a file may define."""


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
    """Runs a file and takes the parts that it defines.

    The file can import modules beside it. Its ``__name__`` is not ``"__main__"``, so
    that a program's own run does not start.

    Args:
        path: Path of the file; None for no parts.

    Returns:
        Arguments of ``AtlasSimulation``.

    Raises:
        ScenarioError: If the file fails, or defines no part.
    """
    if path is None:
        return {}
    folder = str(path.resolve().parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        names = runpy.run_path(str(path), run_name="atlas_drake_parts")
    except AtlasError:
        raise
    except Exception as error:
        raise ScenarioError(
            OPTION, str(path), f"{path} failed: {type(error).__name__}: {error}"
        ) from error
    parts = {name: names[name] for name in PARTS if name in names}
    if not parts:
        raise ScenarioError(
            OPTION, str(path), f"{path} defines none of {', '.join(PARTS)}"
        )
    return parts


def behaviors_told(arguments: Sequence[str]) -> str:
    """Makes the text of ``--help`` about the behaviors.

    Args:
        arguments: Arguments of the command line; behaviors of a ``--with`` file are
            included.
    """
    from atlas_drake.messages.behavior_catalog import SHIPPED

    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    add_parts_option(parser)
    entries = list(SHIPPED)
    parts = load_parts(parser.parse_known_args(arguments)[0].parts)
    if "behaviors" in parts:
        from atlas_drake.behaviors.registration import registered

        entries += registered(parts["behaviors"])
    told = [
        f"{entry.name} ({entry.number}): {entry.description.rstrip('.')}"
        for entry in entries
    ]
    return f"Behaviors that a command can ask for: {'; '.join(told)}."
