"""Functions and parts of a campaign, found by name, in a file or in a module."""

from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.errors import did_you_mean, shown
from atlas_drake.simulation.parts_file import parts_in, run_file


@dataclass
class Sources:
    """The user's functions and parts; can be pickled for other processes.

    Attributes:
        files: Python files that define functions and parts; each process runs them.
        functions: Functions by name, from a module that other processes can import.
        parts: Arguments of ``AtlasSimulation``, from such a module.
    """

    files: tuple[str, ...] = ()
    functions: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    parts: Mapping[str, Any] = field(default_factory=dict)

    @functools.cached_property
    def names(self) -> dict[str, Any]:
        """The definitions of all files by name; a later file overrides earlier ones.

        Raises:
            ScenarioError: If a file fails.
        """
        found: dict[str, Any] = {}
        for file in self.files:
            if not Path(file).is_file():
                raise CampaignError("code", file, f"there is no file {file}")
            found |= run_file(Path(file), "code")
        return found

    def all_parts(self) -> dict[str, Any]:
        """Returns the arguments of ``AtlasSimulation``."""
        return {**parts_in(self.names), **self.parts}

    def function(
        self, name: str, path: str, shipped: Mapping[str, Callable[..., Any]]
    ) -> Callable[..., Any]:
        """Finds a function.

        Args:
            name: Name of a shipped function, of the user's own, or ``module:function``.
            path: Path of the field with the name, for the error.
            shipped: Functions of the package by name.

        Raises:
            CampaignError: If there is no such function.
        """
        if ":" in name:
            return _imported(name, path)
        own = {k: v for k, v in self.names.items() if callable(v)}
        known = {**shipped, **own, **self.functions}
        found = known.get(name)
        if not callable(found):
            offered = [*shipped, *self.functions]
            hint = did_you_mean(name, known) or f" There are {', '.join(offered)}."
            raise CampaignError(path, name, f"there is no function {name!r}.{hint}")
        return found

    def fingerprints(self, names: Iterable[str] = ()) -> list[dict[str, str]]:
        """Returns name and hash of each file, to detect changes.

        The files of the functions ``names`` with the form ``module:function`` count.
        """
        modules = [importlib.import_module(n.split(":")[0]) for n in names if ":" in n]
        given = [*modules, *self.functions.values(), *self.parts.values()]
        paths = [Path(file) for file in joined(self.files, _files_of(given))]
        return [
            {
                "name": path.name,
                "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            }
            for path in paths
        ]

    def __getstate__(self) -> dict[str, Any]:
        """Leaves out the definitions, which the other process reads from the files."""
        return {k: v for k, v in vars(self).items() if k != "names"}


def _files_of(values: Iterable[Any]) -> list[str]:
    """Returns the source files of functions and modules that have one."""
    files = []
    for value in values:
        with suppress(TypeError):
            files.append(inspect.getsourcefile(value))
    return [file for file in files if file is not None]


def _imported(name: str, path: str) -> Callable[..., Any]:
    module, _, function = name.partition(":")
    try:
        found = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, ValueError) as error:
        raise CampaignError(path, name, f"is {shown(name)}: {error}") from error
    if not callable(found):
        raise CampaignError(path, name, f"{name} is no function")
    result: Callable[..., Any] = found
    return result


def joined(*lists: Iterable[str | Path]) -> tuple[str, ...]:
    """Returns the files as absolute paths, each once."""
    paths = [str(Path(path).absolute()) for files in lists for path in files]
    return tuple(dict.fromkeys(paths))
