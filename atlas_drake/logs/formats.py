"""Which format a log has, by the ending of its name, and what each format needs.

The formats themselves are in the files beside this one.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake.errors import did_you_mean
from atlas_drake.logs.notes import Header, LogError, LogWriter, Note

FORMATS = {
    ".mcap": ("mcap_file", "McapWriter", "read_mcap"),
    ".npz": ("npz_file", "NpzWriter", "read_npz"),
    ".parquet": ("parquet_file", "ParquetWriter", "read_parquet"),
}
"""Module, writer and reader by ending."""
LOG_EXTRA, PLOT_EXTRA = "log", "plot"
"""Optional dependencies that bring the formats' and the figures' packages."""


class LogFile:
    """A log being written, with errors that name the file.

    Attributes:
        path: Of the file.
    """

    def __init__(self, path: Path, header: Header):
        """Opens the file in the format that its ending says.

        Raises:
            LogError: If the ending is unknown, a package is missing, or the file
                cannot be written.
        """
        self.path = path
        writer = _member(path, 1)
        try:
            self._writer: LogWriter | None = writer(path, header)
        except OSError as error:
            raise self._failure(error) from error

    def row(self, row: np.ndarray) -> None:
        """Keeps one tick, unless the file is closed."""
        self._do("row", row)

    def note(self, note: Note) -> None:
        """Keeps a note, unless the file is closed."""
        self._do("note", note)

    def close(self) -> None:
        """Completes the file; does nothing when it is closed."""
        writer, self._writer = self._writer, None
        if writer is not None:
            try:
                writer.close()
            except OSError as error:
                raise self._failure(error) from error

    def _do(self, name: str, argument: object) -> None:
        if self._writer is not None:
            try:
                getattr(self._writer, name)(argument)
            except OSError as error:
                raise self._failure(error) from error

    def _failure(self, error: OSError) -> LogError:
        return LogError(f"{self.path}: cannot be written: {error.strerror or error}")


def check_format(path: Path) -> None:
    """Checks that a log with that name could be written or read.

    Raises:
        LogError: If the ending is unknown or a package is missing.
    """
    _member(path, 1)


def read_file(path: Path) -> tuple[Header, dict[str, np.ndarray], list[Note]]:
    """Header, channels and notes of a log.

    Raises:
        LogError: If the file cannot be read.
    """
    read = _member(path, 2)
    if not path.exists():
        raise LogError(f"{path}: there is no such file")
    try:
        return read(path)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror or error}") from error
    except LogError as error:
        raise LogError(f"{path}: {error}") from error


class MissingPackageError(LogError):
    """An optional package that is not installed, and how to install it."""


def missing_package(what: str, name: str | None, extra: str) -> MissingPackageError:
    """The error for a package that is not installed.

    Args:
        what: Needs it.
        name: Of the package, or of a module in it.
        extra: Optional dependencies that bring it.
    """
    package = (name or "").partition(".")[0]
    return MissingPackageError(
        f"{what} needs the package {package!r}, which is not installed: "
        f"pip install {package}, or atlas-drake with the extra [{extra}]"
    )


def _member(path: Path, index: int) -> Any:
    entry = FORMATS.get(path.suffix)
    if entry is None:
        hint = did_you_mean(path.suffix, FORMATS)
        raise LogError(f"{path}: a log must end in one of {', '.join(FORMATS)}.{hint}")
    try:
        module = import_module(f"atlas_drake.logs.{entry[0]}")
    except ModuleNotFoundError as error:
        raise missing_package(f"{path}: {path.suffix}", error.name, LOG_EXTRA) from None
    return getattr(module, entry[index])
