"""Logs that are written when they are closed, whole or not at all.

Rows are kept in memory until then.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import IO, TypeAlias

import numpy as np

from atlas_drake.logs.notes import Header, Note
from atlas_drake.whole_file import WholeFile

Write: TypeAlias = Callable[[IO[bytes], Header, np.ndarray, list[Note]], None]
"""Writes header, rows and notes to an open file."""


class WholeLog:
    """Keeps a log until it is closed."""

    def __init__(self, write: Write, path: Path, header: Header):
        """Opens the file, to raise an error now if it cannot be written."""
        self._write = write
        self._file = WholeFile(path)
        self._header = header
        self._tables: list[np.ndarray] = []
        self._notes: list[Note] = []

    def rows(self, table: np.ndarray) -> None:
        """Keeps some ticks."""
        self._tables.append(table)

    def note(self, note: Note) -> None:
        """Keeps a note."""
        self._notes.append(note)

    def close(self) -> None:
        """Writes the file."""
        with self._file as file:
            rows = np.concatenate(self._tables)
            self._write(file, self._header, rows, self._notes)

    def abandon(self) -> None:
        """Leaves no file."""
        self._file.abandon()
