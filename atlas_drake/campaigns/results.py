"""Writes the results of a campaign's folder: table, report and pictures.

The Parquet table has one row for each trial, in the order of their numbers.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from atlas_drake.atomic_write import atomic_write
from atlas_drake.campaigns.errors import check_packages
from atlas_drake.campaigns.folder import CampaignFolder
from atlas_drake.campaigns.report import report
from atlas_drake.campaigns.threshold import Record, Records

REPORT = "report.md"
"""Name of the report in a campaign's folder."""
TABLE = "results.parquet"
"""Name of the table in a campaign's folder."""
VALUE = "set "
"""Prefix of the columns of values that were set or drawn."""
FIGURE = "figure "
"""Prefix of a figure's column if another column has the figure's name."""
SEED = "seed"


def write_results(folder: CampaignFolder) -> tuple[str, list[Path]]:
    """Writes the results as they are now; a campaign may still be running.

    Returns:
        The report, and the files that were written.

    Raises:
        CampaignError: If the folder holds no campaign, or a package of the extra
            ``sweep`` is not installed.
        OSError: If a file cannot be written.
    """
    check_packages()
    campaign = folder.campaign()
    with folder.writing_results():
        records = folder.records()
        table, page = folder.path / TABLE, folder.path / REPORT
        write_parquet(records, table)
        text = report(campaign, records)
        with atomic_write(page, unfinished_as=page.stem) as unfinished:
            unfinished.write_text(text, encoding="utf-8")
        written = [table, page]
        if records:
            # Matplotlib loads only here.
            from atlas_drake.campaigns.figures import write_figures

            written += write_figures(campaign, records, folder.path)
    return text, written


def _row(record: Record) -> dict[str, Any]:
    """Returns a record without its nesting."""
    own = {
        "trial": record["trial"],
        SEED: record["seed"],
        "success": record["success"],
        "missed": "; ".join(record["missed"]) or None,
        "error": record["error"],
        "wall_time_s": record.get("machine", {}).get("wall_time_s"),
        "built_anew": record.get("machine", {}).get("built_anew"),
    }
    values = {VALUE + path: value for path, value in record["values"].items()}
    figures = {
        FIGURE + name if name in own or name.startswith((VALUE, FIGURE)) else name: v
        for name, v in record["figures"].items()
    }
    return own | values | figures


def write_parquet(records: Records, path: Path) -> None:
    """Writes the table, whole or not at all.

    Raises:
        OSError: If the file cannot be written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows = [_row(records[number]) for number in sorted(records)]
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: _column(name, [row.get(name) for row in rows]) for name in names}
    with atomic_write(path, unfinished_as=path.stem) as unfinished:
        pq.write_table(
            pa.table(columns),
            str(unfinished),
            compression="zstd",
            write_page_checksum=True,
        )


def _column(name: str, values: list[Any]) -> Any:
    """Returns a column of one type that holds all values: numbers, flags or text."""
    import pyarrow as pa

    kinds = {type(value) for value in values} - {type(None)}
    if kinds == {bool}:
        return pa.array(values, pa.bool_())
    if kinds == {int}:
        # Tables of several campaigns fit together if all seeds are of one type.
        for whole in (pa.uint64(),) if name == SEED else (pa.int64(), pa.uint64()):
            with suppress(OverflowError):
                return pa.array(values, whole)
    convert: Any = str
    kind = pa.string()
    if kinds and kinds <= {int, float}:
        convert, kind = float, pa.float64()
    return pa.array([None if v is None else convert(v) for v in values], kind)
