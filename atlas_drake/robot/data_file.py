"""Finds the YAML file of a robot or a world: by its name in the package, or by path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from atlas_drake.errors import AtlasError, did_you_mean, shown

ENDINGS = (".yaml", ".yml")
"""Endings by which a path is told from a name."""


def find_data_file(
    given: str | Path,
    folder: Path,
    names: Sequence[str],
    kind: str,
    fault: Callable[[str], AtlasError],
) -> Path:
    """Returns the file, absolute.

    Args:
        given: One of ``names``, or the path of a YAML file, relative to the working
            folder.
        folder: Folder with the files of ``names``.
        names: Names of the files in the package.
        kind: Word for what the file describes, such as ``robot``.
        fault: Makes the error to raise from a problem.

    Raises:
        AtlasError: What ``fault`` made, if there is no such file.
    """
    if str(given) in names:
        return folder / f"{given}.yaml"
    path = Path(given).expanduser()
    if path.suffix not in ENDINGS:
        raise fault(
            f"there is no {kind} {shown(str(given))};{did_you_mean(str(given), names)} "
            f"must be one of {', '.join(names)}, or the path of a {kind}'s file "
            f"({' or '.join('*' + ending for ending in ENDINGS)})"
        )
    path = path.absolute()
    if not path.is_file():
        raise fault(
            f"there is no file {path}; give the path of a {kind}'s YAML file, or one "
            f"of {', '.join(names)}"
        )
    return path


def file_beside(given: str, folder: Path, names: Sequence[str]) -> str:
    """Returns a name unchanged, or a path made absolute from ``folder``."""
    if given in names or Path(given).suffix not in ENDINGS:
        return given
    return str((folder / Path(given).expanduser()).absolute())
