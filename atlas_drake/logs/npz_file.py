"""Logs as numpy's .npz: one array per channel, for Python without further packages.

Rows are kept in memory until the end, because the format cannot be appended to.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake.logs.notes import (
    Header,
    Note,
    notes_from_json,
    notes_to_json,
)
from atlas_drake.whole_file import WholeFile


class NpzWriter:
    """Writes the file when it is closed, whole or not at all."""

    def __init__(self, path: Path, header: Header):
        """Opens the file, to raise an error now if it cannot be written."""
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
        arrays: dict[str, Any] = self._header.layout.split(np.concatenate(self._tables))
        arrays["header"] = np.array(self._header.to_json())
        arrays["notes"] = np.array(notes_to_json(self._notes))
        with self._file as file:
            np.savez_compressed(file, **arrays)

    def abandon(self) -> None:
        """Leaves no file: it is written whole or not at all."""
        self._file.abandon()


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
