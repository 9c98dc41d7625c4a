"""The report of a campaign, made of its folder alone: table, statistics, figures.

Markdown with the figures in it; the Parquet table has one row for each trial.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from atlas_drake.atomic_write import atomic_write
from atlas_drake.clients.campaigns.campaign import Campaign, figure_of
from atlas_drake.clients.campaigns.plan import Records, Search, case_list
from atlas_drake.clients.campaigns.results import read_campaign, read_records
from atlas_drake.clients.campaigns.shipped import FIRST_FAILURE, FIRST_FAILURE_AT
from atlas_drake.clients.campaigns.table import (
    FIGURES,
    VALUES,
    case_label,
    check_packages,
    label,
    numeric_figures,
    share_interval,
    table_of,
)
from atlas_drake.errors import printable

if TYPE_CHECKING:
    import pandas as pd

REPORT, TABLE = "report.md", "results.parquet"
"""Names in a campaign's folder."""
SHOWN_ERRORS, SHOWN_FAILURES = 3, 20
"""Largest numbers of different errors and of failed trials in a report."""
SHOWN_CASES = 12
"""Largest number of cases of which first failures are shown one by one."""


def write_results(folder: Path) -> tuple[str, list[Path]]:
    """Writes table, report and figures of the trials so far; returns text and files."""
    check_packages()
    campaign, records = read_campaign(folder), read_records(folder)
    frame, text = table_of(records), report(campaign, records)
    pages = []
    if records:
        # Matplotlib loads only here.
        from atlas_drake.clients.campaigns.figures import write_figures

        pages = write_figures(campaign, records, folder)
    text += "".join(f"\n![{page.stem}]({page.name})\n" for page in pages)
    with atomic_write(folder / REPORT) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    for name in frame:
        if frame[name].dtype == object and name != "missed":  # Of several types.
            frame[name] = frame[name].map(str, na_action="ignore").astype("string")
    with atomic_write(folder / TABLE) as unfinished:
        frame.to_parquet(unfinished)
    return text, [folder / TABLE, folder / REPORT, *pages]


def report(campaign: Campaign, records: Records) -> str:
    """Returns the report as Markdown, without figures."""
    frame = table_of(records)
    parts = [f"# {printable(campaign.name)}: {len(records)} trials"]
    if campaign.threshold is not None:
        parts.append(_thresholds(campaign, records))
    if records:
        parts += [
            _successes(campaign, frame),
            _first_failures(campaign, frame),
            _figures(frame),
            _missed(campaign, frame),
            _failed(frame),
        ]
    return "\n\n".join(filter(None, parts)) + "\n"


def share_text(successes: int, trials: int) -> str:
    """Returns a share with its interval, in percent."""
    low, high = share_interval(successes, trials)
    share = 100.0 * successes / trials
    return f"{share:.1f} % ({100 * low:.1f} to {100 * high:.1f} %)"


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns a table in Markdown; without rows, an empty text."""
    lines = [head, ["---"] * len(head), *rows]
    cells = [" | ".join(map(printable, line)) for line in lines[2:] and lines]
    return "\n".join(f"| {line} |" for line in cells)


def _successes(campaign: Campaign, frame: pd.DataFrame) -> str:
    """Counts the successes, also by each value that several trials share."""
    groups = [("all", frame["success"])]
    for column in frame.filter(regex=f"^{VALUES}"):
        path = column.removeprefix(VALUES)
        if not _repeats(campaign, path):
            continue
        number = frame[column].dtype.kind in "iuf"
        rows = frame.sort_values(column) if number else frame
        same = rows["success"].groupby(rows[column].map(label), sort=False)
        groups += [(f"{path} = {value}", mine) for value, mine in same]
    head = ["trials", "successes", "share, with its interval of 95 %"]
    table = []
    for name, mine in groups:
        good, count = int(mine.sum()), len(mine)
        table.append([name, f"{good} of {count}", share_text(good, count)])
    return markdown(head, table)


def _repeats(campaign: Campaign, path: str) -> bool:
    """Returns True if several trials have the same value at the path."""
    drawn = campaign.vary.get(path, {})
    threshold = campaign.threshold
    return (
        path in campaign.cases
        or not drawn.keys().isdisjoint(("choice", "sign"))
        or (threshold is not None and path == threshold.of)
    )


def _first_failures(campaign: Campaign, frame: pd.DataFrame) -> str:
    """Counts what happened first in the trials that failed, by case."""
    if FIGURES + FIRST_FAILURE not in frame:
        return ""
    paths = sorted(campaign.cases)
    if len(case_list(campaign)) > SHOWN_CASES:
        paths = []
    values = frame[[VALUES + path for path in paths]].to_dict("split")["data"]
    cases = [case_label(dict(zip(paths, row, strict=True))) for row in values]
    frame = frame.assign(case=cases)
    failed = frame[~frame["success"] & frame[FIGURES + FIRST_FAILURE].notna()]
    what = failed[FIGURES + FIRST_FAILURE].astype(str)
    if FIGURES + FIRST_FAILURE_AT in frame:
        place = failed[FIGURES + FIRST_FAILURE_AT].fillna("").astype(str)
        what = (what + " " + place).str.strip()
    table = [
        [case, kind, f"{count} of {cases.count(case)}"]
        for case, mine in what.groupby(failed["case"], sort=False)
        for kind, count in mine.value_counts().items()
    ]
    return markdown(["trials", "first failure", "failures"], table)


def _figures(frame: pd.DataFrame) -> str:
    names = numeric_figures(frame)
    quantiles = frame[names].astype(float).quantile([0.0, 0.05, 0.5, 0.95, 1.0])
    table = [
        [name.removeprefix(FIGURES), *(f"{q:.4g}" for q in quantiles[name])]
        for name in names
    ]
    return markdown(["figure", "min", "5 %", "median", "95 %", "max"], table)


def _thresholds(campaign: Campaign, records: Records) -> str:
    assert campaign.threshold is not None
    table = []
    for index in range(len(case_list(campaign))):
        found = Search(campaign, index, records)
        passed = f"{found.passed:g}" + (" so far" if found.next_trials else "")
        failed = "nothing tried" if found.failed is None else f"{found.failed:g}"
        table.append([case_label(found.case), passed, failed])
    head = [campaign.threshold.of, "highest passed", "lowest failed"]
    return markdown(head, table)


def _missed(campaign: Campaign, frame: pd.DataFrame) -> str:
    """Lists the conditions of success that were missed, and how often."""
    lines = []
    for text in campaign.success:
        count = sum(text in missed for missed in frame["missed"])
        if count:
            name = figure_of(text)
            known = FIGURES + name in frame
            unknown = "" if known else f"; no trial has a figure `{name}`"
            lines.append(
                f"- `{printable(text)}` missed in {count} of {len(frame)}{unknown}"
            )
    return "\n".join(lines)


def _failed(frame: pd.DataFrame) -> str:
    """Lists the trials that failed, and the errors."""
    lines = []
    failing = list(frame["trial"][~frame["success"]].map(str))
    if failing:
        shown, more = failing[:SHOWN_FAILURES], len(failing) - SHOWN_FAILURES
        rest = f" and {more} more" if more > 0 else ""
        lines.append(f"Trials that failed: {', '.join(shown)}{rest}.")
    raised = frame.dropna(subset="error")
    last = raised["error"].map(lambda error: error.strip().splitlines()[-1])
    for text, trials in list(raised["trial"].groupby(last, sort=False))[:SHOWN_ERRORS]:
        first = trials.iloc[0]
        lines.append(
            f"Raised in {len(trials)}, first in trial {first}: {printable(text)}"
        )
    return "\n\n".join(lines)
