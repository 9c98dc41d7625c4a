"""Compares two configurations on the same seeds, trial by trial."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from atlas_drake.campaigns.errors import CampaignError, check_packages
from atlas_drake.campaigns.report import (
    LEVEL,
    figure_names,
    markdown,
    share_text,
)
from atlas_drake.campaigns.threshold import Record, Records
from atlas_drake.config import is_number

Pairs = list[tuple[Record, Record]]


def compare(first: Records, second: Records, names: tuple[str, str]) -> str:
    """Returns the differences of two campaigns as Markdown.

    Trials with the same number, the key of their record, make a pair; trials without a
    partner are left out.

    Raises:
        CampaignError: If there is no pair, the seeds of a pair differ, or a package of
            the extra ``sweep`` is not installed.
    """
    check_packages()
    numbers = sorted(set(first) & set(second))
    if not numbers:
        raise CampaignError("folder", names[1], "the two have no trial in common")
    for number in numbers:
        one, other = first[number]["seed"], second[number]["seed"]
        if one != other:
            problem = f"trial {number} has the seed {other}, and {one} in {names[0]}"
            raise CampaignError("folder", names[1], f"{problem}: nothing is paired")
    pairs = [(first[number], second[number]) for number in numbers]
    title = f"# {names[0]} and {names[1]}: {len(pairs)} paired trials"
    return "\n\n".join([title, _successes(pairs, names), _figures(pairs, names)]) + "\n"


def _successes(pairs: Pairs, names: tuple[str, str]) -> str:
    counts = [sum(pair[side]["success"] for pair in pairs) for side in (0, 1)]
    table = markdown(
        ["", "successes", "share, with its interval of 95 %"],
        [
            [name, str(count), share_text(count, len(pairs))]
            for name, count in zip(names, counts, strict=True)
        ],
    )
    only_first = sum(a["success"] > b["success"] for a, b in pairs)
    only_second = sum(b["success"] > a["success"] for a, b in pairs)
    text = (
        f"Only {names[0]} succeeded in {only_first}, only {names[1]} in {only_second}: "
        f"p = {mcnemar(only_first, only_second):.3g} (McNemar's exact test)."
    )
    return f"{table}\n\n{text}"


def _figures(pairs: Pairs, names: tuple[str, str]) -> str:
    """Returns the table of means and paired differences, of pairs with both numbers."""
    table = []
    for name in figure_names([a for a, _ in pairs]):
        values = [(a["figures"].get(name), b["figures"].get(name)) for a, b in pairs]
        both = np.array([v for v in values if all(map(is_number, v))], dtype=float)
        if not len(both):
            continue
        means, differences = both.mean(axis=0), both[:, 1] - both[:, 0]
        interval = mean_interval(differences.tolist())
        spread = "one pair only"
        if interval is not None:
            spread = f"{interval[0]:+.3g} to {interval[1]:+.3g}"
        table.append(
            [
                name,
                f"{means[0]:.4g}",
                f"{means[1]:.4g}",
                f"{differences.mean():+.3g} ({spread})",
            ]
        )
    head = ["mean of", *names, "paired difference, with its interval of 95 %"]
    return markdown(head, table)


def mcnemar(only_first: int, only_second: int) -> float:
    """Returns McNemar's exact two-sided p-value that two success rates are equal.

    The arguments are the numbers of pairs of which only one succeeded.
    """
    from scipy.stats import binomtest

    discordant = only_first + only_second
    return float(binomtest(only_first, discordant).pvalue) if discordant else 1.0


def mean_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """Returns Student's t interval of a mean; None for fewer than two values."""
    from scipy.stats import sem, t

    if len(values) < 2:
        return None
    mean = sum(values) / len(values)
    half = t.ppf(0.5 + 0.5 * LEVEL, len(values) - 1) * sem(values)
    return float(mean - half), float(mean + half)
