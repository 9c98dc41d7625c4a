"""Writes table, report and pictures of a folder of results."""

from __future__ import annotations

from pathlib import Path

from atlas_drake.campaigns.folder import CampaignFolder
from atlas_drake.campaigns.packages import check_packages
from atlas_drake.campaigns.report import report
from atlas_drake.campaigns.table import FILE, write_parquet
from atlas_drake.whole_file import whole_file

REPORT = "report.md"
"""Name of the report in a campaign's folder."""


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
    campaign, records = folder.campaign(), folder.records()
    table, page = folder.path / FILE, folder.path / REPORT
    write_parquet(records, table)
    text = report(campaign, records)
    with whole_file(page) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    written = [table, page]
    if records:
        # Matplotlib loads only here.
        from atlas_drake.campaigns.figures import write_figures

        written += write_figures(campaign, records, folder.path)
    return text, written
