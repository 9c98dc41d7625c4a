"""Finds a robot's URDF: beside its YAML file, or in a package.

Drake's ``PackageMap`` fetches ``drake_models`` once and keeps it. This module replaces
it by a local copy, if there is one, and reports within seconds if there is neither.
"""

from __future__ import annotations

import os
import threading
from pathlib import Path

from pydrake.multibody.parsing import PackageMap

from atlas_drake.errors import RobotDescriptionError, shown

LOCAL_MODELS = "ATLAS_DRAKE_MODELS"
"""Environment variable that names a folder with the content of ``drake_models``."""
ROS_PATH = "ROS_PACKAGE_PATH"
"""Environment variable that names folders with ROS packages, separated by colons."""
PATIENCE = 5.0
"""Longest wait for the network to answer before models are fetched [s]. Drake's own
download waits half a minute at each of three addresses."""
_MODELS = "drake_models"
_PACKAGE = "package://"
_ORIGIN = "https://github.com/RobotLocomotion/models"
_ADVICE = (
    f"set {LOCAL_MODELS} to a folder with the content of {_ORIGIN}, or let Drake fetch "
    "it over the network, once"
)


def find_urdf(folder: Path, urdf: str) -> Path:
    """Returns a robot's URDF file; Drake's models are fetched if they must be.

    Args:
        folder: That of the robot's YAML file.
        urdf: As that names it: a path from there, or ``package://PACKAGE/PATH``.

    Raises:
        RobotDescriptionError: If there is no such file, or no copy of the models.
    """
    if not urdf.startswith(_PACKAGE):
        path = folder / urdf
        if not path.is_file():
            problem = f"there is no file {path}; give its path from this file"
            raise RobotDescriptionError("urdf", str(path), problem)
        return path
    package, _, inner = urdf.removeprefix(_PACKAGE).partition("/")
    if package != _MODELS:
        return _in_package(package, inner, folder, urdf)
    models = _models()
    if not (models / inner).is_file():
        source = f"{LOCAL_MODELS} names" if _local() else f"Drake has {_MODELS} in"
        problem = f"{source} {models}, which has no {inner}; {_ADVICE}"
        raise RobotDescriptionError("urdf", urdf, problem)
    return models / inner


def add_packages(packages: PackageMap, file: Path | None) -> None:
    """Adds to Drake's packages those of a local copy, of the file, and of ROS.

    Args:
        packages: Map of Drake's parser, which knows Drake's models.
        file: The nearest ``package.xml`` above it names a package; None for no file.

    Raises:
        RuntimeError: If a ``package.xml`` is faulty.
    """
    local = _local()
    if local is not None and local.is_dir():
        packages.Remove(_MODELS)
        packages.Add(_MODELS, str(local))
    folders = [] if file is None else file.absolute().parents
    manifests = (folder / "package.xml" for folder in folders)
    nearest = next(filter(Path.is_file, manifests), None)
    if nearest is not None:
        packages.AddPackageXml(str(nearest))
    packages.PopulateFromRosPackagePath()


def models_at_hand() -> bool:
    """Tells whether Drake's models are available without the network."""
    local = _local()
    if local is not None:
        return local.is_dir()
    # Drake's own order. If the cache holds another version, Drake fetches its own.
    places = (("TEST_TMPDIR", ".cache"), ("XDG_CACHE_HOME", ""), ("HOME", ".cache"))
    caches = [
        Path(os.environ[name], inner) for name, inner in places if os.environ.get(name)
    ]
    return any(any(cache.glob("drake/package_map/*/atlas")) for cache in caches)


def _in_package(package: str, inner: str, folder: Path, urdf: str) -> Path:
    """Returns a robot's URDF in a package that is not Drake's.

    Raises:
        RobotDescriptionError: If there is no such package or file.
    """
    packages = PackageMap()
    try:
        add_packages(packages, folder / inner)
    except RuntimeError as error:
        raise RobotDescriptionError("urdf", urdf, str(error)) from error
    if not packages.Contains(package):
        problem = (
            f"is {shown(urdf)}; {package} is neither {_MODELS}, nor named by a "
            f"package.xml above {folder}, nor in a folder of {ROS_PATH}"
        )
        raise RobotDescriptionError("urdf", urdf, problem)
    path = Path(packages.GetPath(package)) / inner
    if not path.is_file():
        raise RobotDescriptionError("urdf", urdf, f"there is no file {path}")
    return path


def _local() -> Path | None:
    """Returns the folder that the environment variable names, absolute."""
    named = os.environ.get(LOCAL_MODELS)
    return Path(named).expanduser().absolute() if named else None


def _models() -> Path:
    """Returns the folder of the models; Drake fetches them if necessary.

    Raises:
        RobotDescriptionError: If they are not available and cannot be fetched.
    """
    local = _local()
    if local is not None:
        return local
    silence = "" if models_at_hand() else _network_silence()
    try:
        if silence:
            raise RuntimeError(silence)
        return Path(PackageMap().GetPath(_MODELS))
    except RuntimeError as error:
        problem = f"Drake cannot fetch {_MODELS}: {error}; {_ADVICE}"
        raise RobotDescriptionError("urdf", _MODELS, problem) from None


def _network_silence() -> str:
    """Returns why the origin of the models does not answer; empty if it answers."""
    import urllib.error
    import urllib.request

    allowed = os.environ.get("DRAKE_ALLOW_NETWORK")
    if allowed is not None and "package_map" not in allowed.split(":"):
        return "DRAKE_ALLOW_NETWORK does not allow package_map"
    answers = [f"{_ORIGIN} does not answer within {PATIENCE:g} s"]

    def ask() -> None:
        request = urllib.request.Request(_ORIGIN, method="HEAD")
        try:
            urllib.request.urlopen(request, timeout=PATIENCE).close()
        except urllib.error.HTTPError:
            answers.append("")  # It answers.
        except OSError as error:
            answers.append(f"{_ORIGIN} cannot be reached ({error})")
        else:
            answers.append("")

    # Looking up the name has no time limit of its own, hence the thread.
    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return answers[-1]
