"""Formats of logs, by file name ending, with the packages that each format needs.

The formats themselves are in the files beside this one.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
"""Module, writer and reader of each format, by file name ending."""
LOG_EXTRA, PLOT_EXTRA = "log", "plot"
"""Extras of the package that install the packages of formats and figures."""


class LogFile:
    """A log being written, with errors that name the file.

    Without a row no log is written, and an earlier file of that name stays.

    Attributes:
        path: Path of the file.
    """

    def __init__(self, path: Path, header: Header):
        """Opens the file in the format of its ending.

        Raises:
            LogError: If the ending is unknown, a package is missing, or the file
                cannot be written.
        """
        self.path = path
        writer, _ = _writer_and_reader(path)
        self._writer: LogWriter | None = None
        self._has_rows = False
        self._early: list[Note] = []
        with self._named_faults():
            self._writer = writer(path, header)

    def rows(self, table: np.ndarray) -> None:
        """Writes some ticks, shape (k, layout's width), unless the file is closed.

        Raises:
            LogError: If it cannot be written. The file is then closed.
        """
        if self._writer is not None:
            with self._named_faults():
                self._writer.rows(table)
                self._has_rows = True
                while self._early:
                    self._writer.note(self._early.pop(0))

    def note(self, note: Note) -> None:
        """Writes a note, unless the file is closed.

        Raises:
            LogError: If it cannot be written. The file is then closed.
        """
        if self._writer is None:
            return
        if not self._has_rows:
            self._early.append(note)
        else:
            with self._named_faults():
                self._writer.note(note)

    def close(self) -> None:
        """Completes the file; does nothing when it is closed.

        Raises:
            LogError: If it cannot be written.
        """
        if self._writer is not None:
            with self._named_faults():
                if self._has_rows:
                    self._writer.close()
                else:
                    self._writer.abandon()
            self._writer = None

    @contextmanager
    def _named_faults(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if self._writer is not None:
                self._writer.abandon()
                self._writer = None
            raise LogError(
                f"{self.path}: cannot be written: {error.strerror or error}"
            ) from error


def check_format(path: Path) -> None:
    """Checks that a log with that name could be written or read.

    Raises:
        LogError: If the ending is unknown or a package is missing.
    """
    _writer_and_reader(path)


def read_file(path: Path) -> tuple[Header, dict[str, np.ndarray], list[Note]]:
    """Reads header, channels and notes of a log.

    Raises:
        LogError: If the file cannot be read.
    """
    _, read = _writer_and_reader(path)
    try:
        if not path.exists():
            raise LogError("there is no such file")
        return read(path)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror or error}") from error
    except LogError as error:
        raise LogError(f"{path}: {error}") from error
    except Exception as error:
        # For a damaged file the reading libraries may raise any exception.
        raise LogError(
            f"{path}: it is not a {path.suffix} log file, or it is damaged"
        ) from error


class MissingPackageError(LogError):
    """An optional package that is not installed, and how to install it."""


def missing_package(what: str, name: str | None, extra: str) -> MissingPackageError:
    """Makes the error for a package, or a module in it, that an extra would install."""
    package = (name or "").partition(".")[0]
    return MissingPackageError(
        f"{what} needs the package {package!r}, which is not installed: "
        f"pip install {package}, or atlas-drake with the extra [{extra}]"
    )


def _writer_and_reader(path: Path) -> tuple[Any, Any]:
    """Finds the writer and the reader of a log with that name."""
    if path.suffix not in FORMATS:
        hint = did_you_mean(path.suffix, FORMATS)
        raise LogError(f"{path}: a log must end in one of {', '.join(FORMATS)}.{hint}")
    name, writer, reader = FORMATS[path.suffix]
    try:
        module = import_module(f"atlas_drake.logs.{name}")
    except ModuleNotFoundError as error:
        raise missing_package(f"{path}: {path.suffix}", error.name, LOG_EXTRA) from None
    return getattr(module, writer), getattr(module, reader)
