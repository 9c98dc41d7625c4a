"""All results of a campaign as one table, in memory and as Parquet.

A row per trial, in the order of their numbers. Needs ``pyarrow`` for the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.whole_file import whole_file

FILE = "results.parquet"
"""Name of the table in a campaign's folder."""
VALUE = "set "
"""Begins the name of a column of what was set or drawn."""

Records = Mapping[int, Mapping[str, Any]]


def check_pyarrow() -> None:
    """Misses pyarrow before the first trial rather than after the last.

    Raises:
        CampaignError: If it is not installed.
    """
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise CampaignError(
            "--out", FILE, 'needs pyarrow: pip install "atlas-drake[sweep]"'
        ) from None


def columns(records: Records) -> dict[str, list[Any]]:
    """Columns by name, all of the same length; what a trial lacks is None."""
    rows = [row_of(records[number]) for number in sorted(records)]
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: _uniform([row.get(name) for row in rows]) for name in names}


def row_of(record: Mapping[str, Any]) -> dict[str, Any]:
    """A record without its nesting."""
    figures = {k: v for k, v in record["figures"].items() if k != "success"}
    return {
        "trial": record["trial"],
        "seed": record["seed"],
        "success": record["success"],
        "missed": "; ".join(record["missed"]) or None,
        "error": record["error"],
        **{VALUE + path: value for path, value in record["values"].items()},
        **figures,
        **record.get("machine", {}),
    }


def _uniform(values: list[Any]) -> list[Any]:
    """Values of one kind, as a column needs them: numbers, truth values or words."""
    kinds = {type(value) for value in values} - {type(None)}
    if len(kinds) <= 1 and not kinds & {list, dict}:
        return values
    if kinds <= {int, float}:
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]


def write_parquet(records: Records, path: Path) -> None:
    """Writes the table, whole or not at all.

    Raises:
        CampaignError: If pyarrow is not installed.
        OSError: If the file cannot be written.
    """
    check_pyarrow()
    import pyarrow as pa
    import pyarrow.parquet as pq

    # Seeds go up to 2^64 - 1; texts that no trial has would be of no type.
    types = {"seed": pa.uint64(), "missed": pa.string(), "error": pa.string()}
    arrays = {
        name: pa.array(values, type=types.get(name))
        for name, values in columns(records).items()
    }
    with whole_file(path) as unfinished:
        pq.write_table(
            pa.table(arrays),
            str(unfinished),
            compression="zstd",
            write_page_checksum=True,
        )
