"""Adds models from files to a plant with Drake's parser, and checks what it warns of.

Drake replaces a mass or an inertia that cannot be by one that can, with a warning: here
that is an error. Other warnings pass once of each kind, because a robot is parsed for
every plant that models it, and an element that Drake does not know often occurs once
per joint.
"""

from __future__ import annotations

import logging
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from atlas_drake.robot.packages import add_packages

_LINE = re.compile(r":\d+:")
"""A line's number, after the file's name."""
_PHYSICS = re.compile(r"warning: .*\b(mass|inertia|limit)\b", re.DOTALL)
"""A warning about a value that Drake replaces by another, or leaves out."""

_passed: set[str] = set()
"""Passed warnings of this process, each with its file and without its line."""


def parse(plant: MultibodyPlant, file: str | Path) -> list[ModelInstanceIndex]:
    """Adds the models of a file to a plant that is not finalized yet.

    Args:
        plant: Plant to add to.
        file: Path of the file, or a URL such as ``package://drake_models/...``.

    Returns:
        The models; those whose name is taken got another one.

    Raises:
        RuntimeError: If the file or a mesh is missing or faulty.
    """
    parser = Parser(plant)
    parser.SetAutoRenaming(True)
    is_url = isinstance(file, str) and "://" in file
    add_packages(parser.package_map(), None if is_url else Path(file))
    with _checked_warnings():
        try:
            if is_url:
                return parser.AddModels(url=file)
            return parser.AddModels(Path(file))
        except SystemExit as error:  # Drake's assertions.
            reason = _reversed_limits(Path(file)) or str(error)
            raise RuntimeError(reason) from error


def _reversed_limits(file: Path) -> str:
    """Tells which joint of a URDF has limits in the wrong order; empty for none."""
    if file.suffix != ".urdf":
        return ""
    for joint in ElementTree.parse(file).iter("joint"):
        limit = joint.find("limit")
        if limit is None:
            continue
        name = joint.get("name")
        lower, upper = (float(limit.get(end, 0.0)) for end in ("lower", "upper"))
        if lower > upper:
            return (
                f"joint {name} has its lower limit {lower:g} above the upper {upper:g}"
            )
        for key, value in limit.items():
            if key.endswith(("velocity", "acceleration")) and float(value) < 0.0:
                return f"joint {name} has the {key} limit {value}; must not be below 0"
    return ""


class _Warnings(logging.Filter):
    """Collects warnings about physics, and passes others once.

    Attributes:
        faults: The collected warnings.
        level: Least level of a record that passes.
    """

    def __init__(self, level: int) -> None:
        super().__init__()
        self.faults: list[str] = []
        self.level = level

    def filter(self, record: logging.LogRecord) -> bool:
        message = record.getMessage()
        if record.levelno == logging.WARNING:
            if _PHYSICS.search(message):
                self.faults.append(message)
                return False
            kind = _LINE.sub(":", message, count=1)
            if kind in _passed:
                return False
            _passed.add(kind)
        return record.levelno >= self.level


@contextmanager
def _checked_warnings() -> Iterator[None]:
    """Raises what Drake only warns of, even where its log is silenced.

    Raises:
        RuntimeError: With the warnings about physics.
    """
    logger, disabled = logging.getLogger("drake"), logging.root.manager.disable
    level = logger.level
    warnings = _Warnings(max(logger.getEffectiveLevel(), disabled + 1))
    logger.addFilter(warnings)
    logging.disable(logging.NOTSET)
    logger.setLevel(min(logger.getEffectiveLevel(), logging.WARNING))
    try:
        yield
    finally:
        logger.setLevel(level)
        logging.disable(disabled)
        logger.removeFilter(warnings)
    if warnings.faults:
        raise RuntimeError("; ".join(warnings.faults))
