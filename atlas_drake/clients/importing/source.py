"""The file of a robot: a path, or the name of a robot in an installed package."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.clients.importing.findings import ImportRefused
from atlas_drake.errors import did_you_mean

PACKAGES = ("example-robot-data", "jvrc-description")
"""Packages of robots on PyPI, of the extra ``robots``."""
USUAL = {
    "talos": "talos_reduced",
    "g1": "g1_29dof_rev_1_0",
    "icub": "icub_reduced",
    "romeo": "romeo_small",
    "alexander": "alexander_v1.lowerBodyOnly",
    "jvrc": "jvrc1",
}
"""Files, without their ending, that a robot's short name means."""


def find_source(given: str) -> Path:
    """Returns the URDF file of a path or of a robot's name, absolute."""
    path = Path(os.path.expanduser(given))
    problem = why_not_readable(path)
    if path.suffix and problem is None:
        if path.suffix.lower() != ".urdf":
            raise ImportRefused(
                f"{path}: only URDF is read; convert {path.suffix} (or xacro) to .urdf "
                "first"
            )
        return path.absolute()
    if os.path.isdir(path):
        raise ImportRefused(f"{path}: is a folder; name the .urdf file in it")
    if path.suffix in (".urdf", ".xacro", ".xml", ".sdf") or path.is_absolute():
        raise ImportRefused(f"{path}: {problem or 'is no .urdf file'}")
    known = packaged_robots()
    name = USUAL.get(given, given)
    if name in known:
        return known[name]
    if not known:
        raise ImportRefused(
            f"{given}: there is no such file, and no package of robots is installed: "
            'pip install "atlas-drake[robots]"'
        )
    short = [name for name, file in USUAL.items() if file in known]
    raise ImportRefused(
        f"{given}: there is no such file or robot."
        f"{did_you_mean(given, [*short, *known])} There are {', '.join(short)}, and "
        f"{len(known)} files of the packages by their names"
    )


def packaged_robots() -> dict[str, Path]:
    """Returns the URDF files of installed packages by their names without ending."""
    found = {}
    for package in PACKAGES:
        try:
            listed = files(package) or ()
        except PackageNotFoundError:
            continue
        for file in listed:
            if file.suffix == ".urdf":
                found[file.stem] = Path(str(file.locate())).resolve()
    return found


def resolve(uri: str, urdf: Path, packages: Mapping[str, Path]) -> Path:
    """Returns the file of a mesh's ``uri`` in a URDF.

    A package is one of ``packages``, a folder above with a ``package.xml`` of that
    name, one of that name above or beside those above, or whatever folder above has the
    rest of the path.
    """
    scheme, separator, rest = uri.partition("://")
    if not separator or scheme == "file":
        path = Path(rest) if separator else urdf.parent / uri
        if not path.is_file():
            raise FileNotFoundError(f"there is no file {path}")
        return path
    package, _, rest = rest.partition("/")
    tried = []
    if package in packages:
        tried.append(packages[package] / rest)
    for folder in urdf.parents:
        if folder.name == package or _is_package(folder, package):
            tried.append(folder / rest)
        tried.append(folder / package / rest)
    tried += [folder / rest for folder in urdf.parents]
    for path in tried:
        if path.is_file():
            return path
    raise FileNotFoundError(
        f"{uri} is in no folder above the file; say where: --package {package}=FOLDER"
    )


def _is_package(folder: Path, name: str) -> bool:
    manifest = folder / "package.xml"
    if not manifest.is_file():
        return False
    try:
        return ElementTree.parse(manifest).findtext("name", "").strip() == name
    except ElementTree.ParseError:
        return False
