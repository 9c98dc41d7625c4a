"""Compares two configurations on the same seeds, trial by trial."""

from __future__ import annotations

from typing import TYPE_CHECKING

from atlas_drake.clients.campaigns.plan import Records
from atlas_drake.clients.campaigns.report import markdown, share_text
from atlas_drake.clients.campaigns.table import (
    FIGURES,
    check_packages,
    mcnemar,
    mean_interval,
    numeric_figures,
    table_of,
)
from atlas_drake.errors import ScenarioError

if TYPE_CHECKING:
    import pandas as pd


def compare(first: Records, second: Records, names: tuple[str, str]) -> str:
    """Returns the differences of two campaigns as Markdown.

    Trials with the same number make a pair; trials without a partner are left out.
    """
    check_packages()
    common = first.keys() & second.keys()
    if not common:
        raise ScenarioError("folder", names[1], "the two have no trial in common")
    for number in sorted(common):
        one, other = first[number]["seed"], second[number]["seed"]
        if one != other:
            problem = f"trial {number} has the seed {other}, and {one} in {names[0]}"
            raise ScenarioError("folder", names[1], f"{problem}: nothing is paired")
    one, other = (table_of({n: all_[n] for n in common}) for all_ in (first, second))
    title = f"# {names[0]} and {names[1]}: {len(common)} paired trials"
    successes, figures = _successes(one, other, names), _figures(one, other, names)
    return "\n\n".join(filter(None, [title, successes, figures])) + "\n"


def _successes(one: pd.DataFrame, other: pd.DataFrame, names: tuple[str, str]) -> str:
    a, b = one["success"], other["success"]
    rows = [
        [name, str(found.sum()), share_text(int(found.sum()), len(found))]
        for name, found in zip(names, (a, b), strict=True)
    ]
    head = ["", "successes", "share, with its interval of 95 %"]
    only_first, only_second = int((a & ~b).sum()), int((b & ~a).sum())
    return (
        f"{markdown(head, rows)}\n\nOnly {names[0]} succeeded in {only_first}, only "
        f"{names[1]} in {only_second}: p = {mcnemar(only_first, only_second):.3g} "
        "(McNemar's exact test)."
    )


def _figures(one: pd.DataFrame, other: pd.DataFrame, names: tuple[str, str]) -> str:
    """Returns the table of means and paired differences, of pairs with both numbers."""
    table = []
    for name in numeric_figures(one):
        if name not in numeric_figures(other):
            continue
        differences = (other[name] - one[name]).dropna().astype(float)
        if differences.empty:
            continue
        means = [f"{side[name][differences.index].mean():.4g}" for side in (one, other)]
        interval = mean_interval(list(differences))
        spread = "one pair only"
        if interval is not None:
            spread = f"{interval[0]:+.3g} to {interval[1]:+.3g}"
        paired = f"{differences.mean():+.3g} ({spread})"
        table.append([name.removeprefix(FIGURES), *means, paired])
    head = ["mean of", *names, "paired difference, with its interval of 95 %"]
    return markdown(head, table)
