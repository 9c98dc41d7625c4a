"""Logs as numpy's .npz: one array per channel, for Python without further packages."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np

from atlas_drake.logs.notes import (
    Header,
    Note,
    notes_from_json,
    notes_to_json,
)
from atlas_drake.logs.whole_log import WholeLog


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
