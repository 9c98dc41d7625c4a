"""Adds models from files to a plant with Drake's parser, in its words where it fails.

Drake replaces a mass or an inertia that cannot be by one that can, with a warning: here
that is an error. Other warnings pass once of each kind, because a robot is parsed for
every plant that models it.
"""

from __future__ import annotations

import logging
import os
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pydrake.multibody.parsing import PackageMap, Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.errors import RobotDescriptionError, printable

LOCAL_MODELS = "ATLAS_DRAKE_MODELS"
"""Environment variable that names a folder with the content of ``drake_models``."""
LARGEST_MASS = 1e6
"""Largest mass of a link [kg]."""
_MODELS = "drake_models"
_ADVICE = (
    f"; set {LOCAL_MODELS} to a folder with the content of "
    "https://github.com/RobotLocomotion/models, or let Drake fetch it over the network"
)
_LINE = re.compile(r":(\d+):")
"""A line's number, after the file's name."""
_ELEMENT = re.compile(r"""<(link|joint|body)\b[^>]*?\bname=["']([^"']*)""")
_PHYSICS = re.compile(r"warning: .*\b(mass|inertia|limit)\b", re.DOTALL)
"""A warning about a value that Drake replaces by another, or leaves out."""

_passed: set[str] = set()
"""Passed warnings of this process, each with its file and without its line."""


def find_urdf(folder: Path, urdf: str) -> Path:
    """Returns a robot's URDF file, named by its path from ``folder`` or by package."""
    path = folder / urdf
    if "://" in urdf:
        try:
            packages = PackageMap()
            _add_packages(packages, path)
            path = Path(packages.ResolveUrl(urdf))
        except RuntimeError as error:
            advice = _ADVICE if f"//{_MODELS}/" in urdf else ""
            problem = f"{_one_line(str(error))}{advice}"
            raise RobotDescriptionError("urdf", urdf, problem) from None
    if why_not_readable(path):
        raise RobotDescriptionError("urdf", urdf, f"there is no file {path}")
    return path


def _add_packages(packages: PackageMap, file: Path | None) -> None:
    """Adds a local copy of Drake's models, the package above a file, and ROS' ones."""
    local = os.environ.get(LOCAL_MODELS)
    if local and (folder := Path(os.path.expanduser(local)).absolute()).is_dir():
        packages.Remove(_MODELS)
        packages.Add(_MODELS, str(folder))
    for folder in file.absolute().parents if file else ():
        if (manifest := folder / "package.xml").is_file():
            packages.AddPackageXml(str(manifest))
            break
    packages.PopulateFromRosPackagePath()


def parse(plant: MultibodyPlant, file: str | Path) -> list[ModelInstanceIndex]:
    """Adds the models of a path or a ``package://`` URL to a plant before Finalize.

    Models whose name is taken get another one. A fault is a RuntimeError of one line.
    """
    parser = Parser(plant)
    parser.SetAutoRenaming(True)
    path = None if "://" in str(file) else Path(file)
    _add_packages(parser.package_map(), path)
    if path is not None and path.suffix == ".urdf":
        _check_numbers(path)
    try:
        with _faults() as faults:
            if path is None:
                models: list[ModelInstanceIndex] = parser.AddModels(url=str(file))
            else:
                models = parser.AddModels(path)
    except (Exception, SystemExit) as error:  # Drake raises several kinds.
        raise RuntimeError(_with_element(str(error))) from None
    if faults:
        raise RuntimeError(_with_element(faults[0]))
    return models


def _check_numbers(urdf: Path) -> None:
    """Checks numbers that Drake refuses without naming the link or the joint."""
    try:
        root = ElementTree.parse(urdf)
        for link in root.iter("link"):
            for mass in link.iterfind("inertial/mass"):
                if not 0.0 <= float(mass.get("value", 0.0)) <= LARGEST_MASS:
                    raise RuntimeError(
                        f"link {link.get('name')} has the mass {mass.get('value')} kg; "
                        f"must be above 0, and at most {LARGEST_MASS:g}"
                    )
        for joint in root.iter("joint"):
            for limit in joint.iterfind("limit"):
                ends = (limit.get(name, 0.0) for name in ("lower", "upper"))
                lower, upper = map(float, ends)
                if lower > upper or float(limit.get("velocity", 0.0)) < 0.0:
                    given = ", ".join(f"{k} {v}" for k, v in limit.items())
                    raise RuntimeError(
                        f"joint {joint.get('name')} has the limits {given}; lower must "
                        "not exceed upper, nor velocity be below 0"
                    )
    except (ElementTree.ParseError, ValueError):
        return  # In Drake's words.


def _with_element(said: str) -> str:
    """Returns Drake's words in one line, with the link or joint at their line."""
    file, line, words = (*_LINE.split(said, maxsplit=1), "", "")[:3]
    path = Path(file)
    if not (line and path.is_file()):
        return _one_line(said)
    above = "".join(path.read_text(errors="replace").splitlines(True)[: int(line)])
    elements = _ELEMENT.findall(above)
    where = " ".join(elements[-1]) if elements else path.name
    return _one_line(f"{where}, line {line}: {words}")


def _one_line(text: str) -> str:
    return " ".join(re.sub(r"\b(warning|error): ", "", text).split())


@contextmanager
def _faults() -> Iterator[list[str]]:
    """Collects what Drake only warns of, even where its log is silenced."""
    logger, disabled = logging.getLogger("drake"), logging.root.manager.disable
    level, off, found = logger.level, logger.disabled, list[str]()
    least = max(logger.getEffectiveLevel(), disabled + 1)

    def passes(record: logging.LogRecord) -> bool:
        message = record.getMessage()
        if record.levelno == logging.WARNING:
            if _PHYSICS.search(message):
                found.append(message)
                return False
            kind = _LINE.sub(":", message, count=1)
            if kind in _passed:
                return False
            _passed.add(kind)
        # Names are the file's; the formats of Drake's records are filled in here.
        record.msg, record.args = printable(message), ()
        return not off and record.levelno >= least

    logger.addFilter(passes)
    logging.disable(logging.NOTSET)
    logger.setLevel(min(least, logging.WARNING))
    logger.disabled = False
    try:
        yield found
    finally:
        logger.setLevel(level)
        logger.disabled = off
        logging.disable(disabled)
        logger.removeFilter(passes)
