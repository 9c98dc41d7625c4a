"""Logs as numpy's .npz: one array per channel, for Python without further packages.

``WholeLog`` keeps a log in memory until it is closed; Parquet uses it, too.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import IO, Any, TypeAlias

import numpy as np

from atlas_drake.logs.notes import (
    Header,
    Note,
    notes_from_json,
    notes_to_json,
)
from atlas_drake.whole_file import WholeFile

Write: TypeAlias = Callable[[IO[bytes], Header, np.ndarray, list[Note]], None]
"""Writes header, rows and notes to an open file."""


class WholeLog:
    """A log that is written when it is closed, whole or not at all."""

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


def _write(
    file: IO[bytes], header: Header, rows: np.ndarray, notes: list[Note]
) -> None:
    arrays: dict[str, Any] = header.layout.split(rows)
    arrays["header"] = np.array(header.to_json())
    arrays["notes"] = np.array(notes_to_json(notes))
    np.savez_compressed(file, **arrays)


NpzWriter = partial(WholeLog, _write)


def read_npz(path: Path) -> tuple[Header, dict[str, np.ndarray], list[Note]]:
    """Reads header, channels and notes of a file.

    Raises:
        LogError: If it is not a log of this program.
        Exception: Anything else if it is damaged.
    """
    with np.load(path, allow_pickle=False) as file:
        header = Header.from_json(str(file["header"]))
        arrays = {c.name: file[c.name] for c in header.layout.channels}
        return header, arrays, notes_from_json(str(file["notes"]))
