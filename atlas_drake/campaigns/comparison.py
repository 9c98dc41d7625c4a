"""Two configurations compared on the same seeds, trial by trial."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.intervals import mcnemar, mean_interval
from atlas_drake.campaigns.report import figure_names, markdown, share_text

Records = Mapping[int, Mapping[str, Any]]


def compare(first: Records, second: Records, names: tuple[str, str]) -> str:
    """What differs, as Markdown.

    Trials belong together that have the same number; those that only one has are left
    out.

    Args:
        first: Results of one configuration.
        second: Of the other.
        names: Of the two, for the table.

    Raises:
        CampaignError: If no trials belong together, or their seeds differ.
    """
    numbers = sorted(set(first) & set(second))
    if not numbers:
        raise CampaignError("folder", names[1], "the two have no trial in common")
    for number in numbers:
        one, other = first[number]["seed"], second[number]["seed"]
        if one != other:
            problem = f"trial {number} has the seed {other}, and {one} in {names[0]}"
            raise CampaignError("folder", names[1], f"{problem}: nothing is paired")
    pairs = [(first[number], second[number]) for number in numbers]
    parts = [f"# {names[0]} and {names[1]}: {len(pairs)} paired trials"]
    return (
        "\n\n".join([*parts, _successes(pairs, names), _figures(pairs, names)]) + "\n"
    )


def _successes(
    pairs: list[tuple[Mapping[str, Any], Mapping[str, Any]]], names: tuple[str, str]
) -> str:
    counts = [sum(pair[side]["success"] for pair in pairs) for side in (0, 1)]
    table = markdown(
        ["", "successes", "share, with its interval of 95 %"],
        [
            [name, str(count), share_text(count, len(pairs))]
            for name, count in zip(names, counts, strict=True)
        ],
    )
    only = [sum(a["success"] > b["success"] for a, b in pairs)]
    only.append(sum(b["success"] > a["success"] for a, b in pairs))
    text = (
        f"Only {names[0]} succeeded in {only[0]}, only {names[1]} in {only[1]}: "
        f"p = {mcnemar(*only):.3g} (McNemar's exact test)."
    )
    return f"{table}\n\n{text}"


def _figures(
    pairs: list[tuple[Mapping[str, Any], Mapping[str, Any]]], names: tuple[str, str]
) -> str:
    table = []
    for name in figure_names([a for a, _ in pairs]):
        values = [(a["figures"].get(name), b["figures"].get(name)) for a, b in pairs]
        both = np.array([v for v in values if None not in v], dtype=float)
        if not len(both):
            continue
        differences = both[:, 1] - both[:, 0]
        low, high = mean_interval(differences.tolist())
        means = both.mean(axis=0)
        table.append(
            [
                name,
                f"{means[0]:.4g}",
                f"{means[1]:.4g}",
                f"{differences.mean():+.3g} ({low:+.3g} to {high:+.3g})",
            ]
        )
    head = ["mean of", *names, "paired difference, with its interval of 95 %"]
    return markdown(head, table)
