"""A user's own parts on the command line: ``--with FILE.py``.

The file defines any of ``controller``, ``behaviors``, ``world`` and ``extend``, which
are arguments of ``AtlasSimulation``.
"""

from __future__ import annotations

import argparse
import functools
import traceback
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from atlas_drake.errors import AtlasError, ScenarioError

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
    """Runs a file, if there is one, and takes the parts that it defines.

    Returns:
        Arguments of ``AtlasSimulation``. If a callable of a part fails while the
        simulation is built, it raises a ScenarioError.

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
    return {name: _guarded(part, name, path) for name, part in parts.items()}


def _guarded(part: Any, name: str, path: Path) -> Any:
    """Returns a part whose callables, when they fail, name file, part and line."""
    from atlas_drake.behaviors.entry import BehaviorEntry

    if isinstance(part, list | tuple):
        return [_guarded(one, f"{name}[{i}]", path) for i, one in enumerate(part)]
    if isinstance(part, BehaviorEntry):
        return replace(part, make=_guarded(part.make, f"{name}.make", path))
    if not callable(part):
        return part

    @functools.wraps(part)
    def call(*arguments: Any) -> Any:
        try:
            return part(*arguments)
        except AtlasError:
            raise
        except Exception as error:
            last = traceback.extract_tb(error.__traceback__)[-1]
            raise ScenarioError(
                OPTION,
                str(path),
                f"{name} of {path} failed: {type(error).__name__}: {error} "
                f"({last.filename}:{last.lineno})",
            ) from error

    return call


def behaviors_told(arguments: Sequence[str]) -> str:
    """Makes the text of ``--help`` about the behaviors, with those of ``--with``."""
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
