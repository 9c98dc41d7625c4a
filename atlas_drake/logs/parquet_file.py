"""Logs as Parquet: one column per number, for pandas, polars, DuckDB and the like.

Needs ``pyarrow``. Blocks of rows are written during the run, but the file can only be
read once it is closed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from atlas_drake.logs.layout import Layout
from atlas_drake.logs.notes import (
    Header,
    Note,
    check,
    checksum,
    notes_from_json,
    notes_to_json,
)
from atlas_drake.whole_file import WholeFile

HEADER, NOTES = "atlas_drake.header", "atlas_drake.notes"
"""Keys of the file's metadata."""
CHECKSUM = "atlas_drake.crc32"
"""Key of the checksum of header and notes; Parquet's own cover the rows only."""
GROUP = 1024
"""Least number of rows that are written together."""


class ParquetWriter:
    """Writes to a temporary file beside the log until the log is closed."""

    def __init__(self, path: Path, header: Header):
        """Opens the file."""
        self._schema = _schema(header.layout)
        self._file = WholeFile(path)
        self._writer: Any = pq.ParquetWriter(
            self._file.file,
            self._schema,
            compression="zstd",
            write_page_checksum=True,
        )
        self._header = header.to_json()
        self._tables: list[np.ndarray] = []
        self._notes: list[Note] = []

    def rows(self, table: np.ndarray) -> None:
        """Keeps some ticks."""
        self._tables.append(table)
        if sum(map(len, self._tables)) >= GROUP:
            self._flush()

    def note(self, note: Note) -> None:
        """Keeps a note."""
        self._notes.append(note)

    def close(self) -> None:
        """Completes the file."""
        with self._file:
            try:
                self._flush()
                notes = notes_to_json(self._notes)
                self._writer.add_key_value_metadata(
                    {
                        HEADER: self._header,
                        NOTES: notes,
                        CHECKSUM: checksum(self._header, notes),
                    }
                )
            finally:
                self._writer.close()

    def abandon(self) -> None:
        """Removes the file, which cannot be read without its end."""
        # Otherwise the library would write again, and report an error.
        self._writer.is_open = False
        self._file.abandon()

    def _flush(self) -> None:
        if not self._tables:
            return
        table = np.concatenate(self._tables)
        self._tables = []
        columns = [
            pa.array(column.astype(field.type.to_pandas_dtype()))
            for column, field in zip(table.T, self._schema, strict=True)
        ]
        self._writer.write_table(pa.Table.from_arrays(columns, schema=self._schema))


def read_parquet(path: Path) -> tuple[Header, dict[str, np.ndarray], list[Note]]:
    """Reads header, channels and notes of a file.

    Raises:
        LogError: If it is not a log of this program.
        Exception: Anything else if it is damaged.
    """
    file = pq.ParquetFile(path, page_checksum_verification=True)
    metadata = file.metadata.metadata or {}
    texts = [metadata[key.encode()].decode() for key in (HEADER, NOTES)]
    if CHECKSUM.encode() in metadata:  # Older logs have none.
        check(metadata[CHECKSUM.encode()].decode(), *texts)
    header, notes = Header.from_json(texts[0]), notes_from_json(texts[1])
    table = file.read()
    columns = [table.column(name).to_numpy() for name in header.layout.columns()]
    rows = np.array(columns, dtype=float).T.reshape(-1, header.layout.width)
    return header, header.layout.split(rows), notes


def _schema(layout: Layout) -> Any:
    kinds = [
        np.dtype(channel.kind)
        for channel in layout.channels
        for _ in range(channel.size)
    ]
    names = layout.columns()
    return pa.schema(
        [
            pa.field(name, pa.from_numpy_dtype(kind), nullable=False)
            for name, kind in zip(names, kinds, strict=True)
        ]
    )
