"""Logs as Parquet: one column per number, for pandas, polars, DuckDB and the like.

Needs ``pyarrow``.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import IO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from atlas_drake.logs.notes import (
    Header,
    Note,
    check,
    checksum,
    notes_from_json,
    notes_to_json,
)
from atlas_drake.logs.npz_file import WholeLog

HEADER, NOTES = "atlas_drake.header", "atlas_drake.notes"
"""Keys of the file's metadata."""
CHECKSUM = "atlas_drake.crc32"
"""Key of the checksum of header and notes; Parquet's own cover the rows only."""


def _write(
    file: IO[bytes], header: Header, rows: np.ndarray, notes: list[Note]
) -> None:
    kinds = [entry.kind for entry in header.layout.channels for _ in range(entry.size)]
    columns = {
        name: numbers.astype(kind)
        for name, numbers, kind in zip(
            header.layout.columns(), rows.T, kinds, strict=True
        )
    }
    table = pa.table(columns)
    texts = header.to_json(), notes_to_json(notes)
    with pq.ParquetWriter(
        file, table.schema, compression="zstd", write_page_checksum=True
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(
            {HEADER: texts[0], NOTES: texts[1], CHECKSUM: checksum(*texts)}
        )


ParquetWriter = partial(WholeLog, _write)


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
