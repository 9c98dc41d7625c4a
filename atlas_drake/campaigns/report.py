"""The report of a campaign: successes with intervals, figures, thresholds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.conditions import figure_of
from atlas_drake.campaigns.metrics import FIRST_FAILURE, FIRST_FAILURE_AT
from atlas_drake.campaigns.plan import case_list
from atlas_drake.campaigns.threshold import Record, Records, Search
from atlas_drake.config import is_number

SHOWN_ERRORS = 3
"""Largest number of different errors in a report."""
SHOWN_CASES = 12
"""Largest number of cases of which first failures are shown one by one."""
LEVEL = 0.95
"""Confidence level of every interval [-]."""


def report(campaign: Campaign, records: Records) -> str:
    """Returns the report as Markdown."""
    rows = list(records.values())
    parts = [f"# {campaign.name}: {len(rows)} trials"]
    if campaign.threshold is not None:
        parts.append(_thresholds(campaign, records))
    parts.append(_success_table(campaign, rows))
    texts = (
        _failures_table(campaign, rows),
        _figures_table(rows),
        _missed(campaign, rows),
        _failures(rows),
    )
    parts += [text for text in texts if text]
    return "\n\n".join(parts) + "\n"


def share_interval(successes: int, trials: int) -> tuple[float, float]:
    """Returns Wilson's score interval of a probability, from 1 trial or more."""
    # Scipy takes a second to load.
    from scipy.stats import binomtest

    interval = binomtest(successes, trials).proportion_ci(LEVEL, method="wilson")
    return float(interval.low), float(interval.high)


def share_text(successes: int, trials: int) -> str:
    """Returns a share with its interval, in percent."""
    if trials == 0:
        return "–"
    low, high = share_interval(successes, trials)
    share = 100.0 * successes / trials
    return f"{share:.1f} % ({100 * low:.1f} to {100 * high:.1f} %)"


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def varied_paths(rows: Iterable[Record]) -> list[str]:
    """Returns the paths of the values that differ between trials, in order."""
    return list(dict.fromkeys(path for row in rows for path in row["values"]))


def figure_names(rows: Iterable[Record]) -> list[str]:
    """Returns the names of the figures that are numbers, in order."""
    return list(
        dict.fromkeys(
            name
            for row in rows
            for name, value in row["figures"].items()
            if is_number(value)
        )
    )


def figure_values(rows: Iterable[Record], name: str) -> list[float]:
    """Returns the numbers of a figure, of the trials that have it."""
    found = (row["figures"].get(name) for row in rows)
    return [float(value) for value in found if is_number(value)]


def _success_table(campaign: Campaign, rows: list[Record]) -> str:
    groups = [("all", rows)]
    for path in varied_paths(rows):
        if not _repeats(campaign, path):
            continue
        values = [row["values"].get(path) for row in rows]
        for value in _distinct(values):
            mine = [row for row, own in zip(rows, values, strict=True) if own == value]
            groups.append((f"{path} = {_short(value)}", mine))
    table = []
    for name, mine in groups:
        good = sum(row["success"] for row in mine)
        table.append([name, f"{good} of {len(mine)}", share_text(good, len(mine))])
    return markdown(["trials", "successes", "share, with its interval of 95 %"], table)


def _distinct(values: Iterable[Any]) -> list[Any]:
    """Returns different values in order; they may be lists and mappings."""
    found: list[Any] = []
    for value in values:
        if value not in found:
            found.append(value)
    return sorted(found, key=_order)


def _repeats(campaign: Campaign, path: str) -> bool:
    """Returns True if several trials have the same value at the path."""
    drawn = campaign.vary.get(path, {})
    threshold = campaign.threshold
    return (
        path in campaign.cases
        or not drawn.keys().isdisjoint(("choice", "sign"))
        or (threshold is not None and path == threshold.of)
    )


def _order(value: Any) -> tuple[bool, Any]:
    """Sorts numbers by size, and words after them."""
    return (False, value) if is_number(value) else (True, str(value))


def _failures_table(campaign: Campaign, rows: list[Record]) -> str:
    """Counts what happened first in the trials that failed, by case."""
    table, cases = [], case_list(campaign)
    for case in cases if len(cases) <= SHOWN_CASES else [{}]:
        mine = [row for row in rows if case.items() <= row["values"].items()]
        counts = Counter(
            " ".join(filter(None, (kind, row["figures"].get(FIRST_FAILURE_AT))))
            for row in mine
            if not row["success"] and (kind := row["figures"].get(FIRST_FAILURE))
        )
        if counts:
            name = ", ".join(
                f"{path} = {_short(value)}" for path, value in case.items()
            )
            table += [
                [name or "all", kind, f"{count} of {len(mine)}"]
                for kind, count in counts.most_common()
            ]
    head = ["trials", "first failure", "failures"]
    return markdown(head, table) if table else ""


def _figures_table(rows: list[Record]) -> str:
    table = []
    for name in figure_names(rows):
        values = figure_values(rows, name)
        numbers = [np.min(values), *np.percentile(values, [5, 50, 95]), np.max(values)]
        table.append([name, *(f"{number:.4g}" for number in numbers)])
    head = ["figure", "least", "5 %", "median", "95 %", "most"]
    return markdown(head, table) if table else ""


def _thresholds(campaign: Campaign, records: Records) -> str:
    assert campaign.threshold is not None
    table = []
    for index in range(len(case_list(campaign))):
        found = Search(campaign, index).found(records)
        case = ", ".join(f"{k} = {_short(v)}" for k, v in found.case.items())
        above = "nothing tried" if found.too_much is None else f"{found.too_much:g}"
        borne = f"{found.borne:g}" + ("" if found.ended else " so far")
        table.append([case or "all", borne, above])
    return markdown([campaign.threshold.of, "borne", "too much"], table)


def _missed(campaign: Campaign, rows: list[Record]) -> str:
    """Lists the conditions of success that were missed, and how often."""
    figures = {name for row in rows for name in row["figures"]}
    lines = []
    for text in campaign.success:
        count = sum(text in row["missed"] for row in rows)
        if count:
            name = figure_of(text)
            unknown = "" if name in figures else f"; no trial has a figure `{name}`"
            lines.append(f"- `{text}` missed in {count} of {len(rows)}{unknown}")
    return "\n".join(lines)


def _failures(rows: list[Record]) -> str:
    """Lists the trials that failed, and the errors."""
    lines = []
    failing = [str(row["trial"]) for row in rows if not row["success"]]
    if failing:
        more = f" and {len(failing) - 20} more" if len(failing) > 20 else ""
        lines.append(f"Trials that failed: {', '.join(failing[:20])}{more}.")
    errors: dict[str, list[int]] = {}
    for row in rows:
        if row["error"] is not None:
            last = row["error"].strip().splitlines()[-1]
            errors.setdefault(last, []).append(row["trial"])
    for text, numbers in list(errors.items())[:SHOWN_ERRORS]:
        lines.append(f"Raised in {len(numbers)}, first in trial {numbers[0]}: {text}")
    return "\n\n".join(lines)


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
