"""Parts of one's own on the command line: ``--with FILE.py``.

The file defines, by the names of ``AtlasSimulation``'s arguments, whichever parts it
brings: ``controller``, ``behaviors``, ``world``, ``extend``.
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

    Modules beside the file can be imported by it. Its ``__name__`` is not
    ``"__main__"``, so that a program's own run does not begin.

    Args:
        path: Of the file; None has no parts.

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
    """What ``--help`` says about the behaviors that can be asked for.

    Args:
        arguments: Of the command line; a file that they name brings its behaviors.
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
