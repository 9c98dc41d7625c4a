"""Where a robot's URDF is: beside its YAML file, or among the models that Drake fetches.

Drake's own ``PackageMap`` fetches ``drake_models`` once and keeps it; here is a local
copy put in its place, and what cannot be had is told soon and in words.
"""

from __future__ import annotations

import os
import threading
import urllib.error
import urllib.request
from pathlib import Path

from pydrake.multibody.parsing import PackageMap

from atlas_drake.errors import RobotDescriptionError

LOCAL_MODELS = "ATLAS_DRAKE_MODELS"
"""Environment variable with the folder of a local copy of ``drake_models``."""
_MODELS = "drake_models"
_URL = "package://"
_ORIGIN = "https://github.com/RobotLocomotion/models"
PATIENCE = 5.0
"""Longest wait for an answer of the network before models are fetched [s]. Drake's own
download waits half a minute at each of three addresses."""


def find_urdf(folder: Path, urdf: str) -> Path:
    """Returns a robot's URDF file; its package is fetched if it must be.

    Args:
        folder: That of the robot's YAML file.
        urdf: As the file names it: a path from there, or ``package://NAME/PATH``.

    Raises:
        RobotDescriptionError: If there is no such file, or its package cannot be had.
    """
    if not urdf.startswith(_URL):
        path = folder / urdf
        if not path.is_file():
            problem = f"there is no file {path}; give its path from this file"
            raise RobotDescriptionError("urdf", str(path), problem)
        return path
    package, _, inner = urdf.removeprefix(_URL).partition("/")
    if package != _MODELS:
        problem = f"is {urdf!r}; of packages only {_URL}{_MODELS}/... can be named here"
        raise RobotDescriptionError("urdf", urdf, problem)
    path = _models() / inner
    if not path.is_file():
        found = os.environ.get(LOCAL_MODELS)
        where = f"{LOCAL_MODELS} names {found}" if found else f"{_MODELS} is {path}"
        problem = f"{where}, which has no {inner}; {_ADVICE}"
        raise RobotDescriptionError("urdf", urdf, problem)
    return path


_ADVICE = (
    f"set {LOCAL_MODELS} to a folder with the content of {_ORIGIN}, such as a copy of "
    "it, or let Drake fetch it over the network, once"
)


def use_local_models(packages: PackageMap) -> None:
    """Puts the local copy of the models, if there is one, in place of Drake's."""
    local = os.environ.get(LOCAL_MODELS)
    if local and Path(local).is_dir():
        if packages.Contains(_MODELS):
            packages.Remove(_MODELS)
        packages.Add(_MODELS, str(Path(local).absolute()))


def _models() -> Path:
    """The folder of ``drake_models``.

    Raises:
        RobotDescriptionError: If the models are not at hand and cannot be fetched.
    """
    local = os.environ.get(LOCAL_MODELS)
    if local:
        return Path(local).absolute()
    if not _fetched_before():
        silence = _network_silence()
        if silence:
            raise _out_of_reach(silence)
    try:
        return Path(PackageMap().GetPath(_MODELS))
    except RuntimeError as error:
        raise _out_of_reach(str(error)) from error


def _out_of_reach(reason: str) -> RobotDescriptionError:
    problem = f"Drake cannot fetch {_MODELS}: {reason}; {_ADVICE}"
    return RobotDescriptionError("urdf", _MODELS, problem)


def _fetched_before() -> bool:
    """Whether Drake's cache holds any version of the models; wrong ones are harmless."""
    caches = [os.environ.get(name) for name in ("TEST_TMPDIR", "XDG_CACHE_HOME")]
    caches.append(str(Path.home() / ".cache"))
    cache = next(Path(folder) for folder in caches if folder)
    return any(cache.glob(f"**/package_map/*/atlas"))


def _network_silence() -> str:
    """Why the models' origin does not answer soon; empty if it does."""
    silence = [f"{_ORIGIN} does not answer within {PATIENCE:g} s"]

    def ask() -> None:
        request = urllib.request.Request(_ORIGIN, method="HEAD")
        try:
            urllib.request.urlopen(request, timeout=PATIENCE).close()
        except urllib.error.HTTPError:
            pass  # An answer.
        except OSError as error:
            silence[0] = f"{_ORIGIN} cannot be reached ({error})"
            return
        silence[0] = ""

    # Looking up a name has no time limit of its own, so the wait has.
    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return silence[0]
