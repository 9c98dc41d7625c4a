"""Pictures of a campaign's results: success by value and direction, distributions.

Needs matplotlib.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from atlas_drake.atomic_write import atomic_write
from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.plan import case_list
from atlas_drake.campaigns.report import (
    figure_names,
    figure_values,
    share_interval,
    varied_paths,
)
from atlas_drake.campaigns.threshold import Record, Records, Search
from atlas_drake.config import is_number

BINS, SECTORS = 8, 12
"""Numbers of groups of trials, by a value and by a direction."""
HISTOGRAM_BINS = 20
RELATIVE_WIDTH = 1e-9
"""Least width of a histogram, as a share of its values [-]."""
DPI = 110
GOOD, BAD, QUIET = "#2a7f62", "#c0392b", "#5b6770"
"""Colors of successes, of failures, and of what is neither."""
DIRECTION = ("direction", ".direction")
"""Ends the path of an angle [rad]."""


def write_figures(campaign: Campaign, records: Records, folder: Path) -> list[Path]:
    """Draws every picture for which the results have numbers; returns their paths.

    Raises:
        OSError: If a picture cannot be written.
    """
    rows = list(records.values())
    paths = [p for p in varied_paths(rows) if len(_numbers(rows, p)) == len(rows)]
    angles = [path for path in paths if path.endswith(DIRECTION)]
    sizes = [path for path in paths if path not in angles]
    pages: dict[str, Figure] = {}
    if sizes:
        pages["success_by_value.png"] = _by_value(rows, sizes)
    if angles:
        pages["success_by_direction.png"] = _by_direction(campaign, records, angles[0])
    if figure_names(rows):
        pages["distributions.png"] = _distributions(rows)
    written = []
    for name, figure in pages.items():
        path = folder / name
        figure.suptitle(f"{campaign.name}, {len(rows)} trials", fontsize=11)
        with atomic_write(path, unfinished_as=path.stem) as unfinished:
            figure.savefig(unfinished, dpi=DPI)
        written.append(path)
    return written


def _numbers(rows: list[Record], path: str) -> np.ndarray:
    values = [row["values"].get(path) for row in rows]
    return np.array([value for value in values if is_number(value)], dtype=float)


def _grid(count: int, across: int = 3) -> tuple[Figure, list[Any]]:
    """Makes a figure with ``count`` axes."""
    across = min(count, across)
    down = -(-count // across)
    figure = Figure(figsize=(4.2 * across, 3.1 * down + 0.3), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(down, across, squeeze=False).ravel().tolist()
    for unused in axes[count:]:
        unused.set_visible(False)
    return figure, axes[:count]


def _by_value(rows: list[Record], paths: list[str]) -> Figure:
    """Draws the share of successes over each value, with Wilson's intervals."""
    figure, all_axes = _grid(len(paths))
    success = np.array([row["success"] for row in rows], dtype=bool)
    for axes, path in zip(all_axes, paths, strict=True):
        values = _numbers(rows, path)
        distinct = np.unique(values)
        if len(distinct) <= BINS:
            groups = [(value, values == value) for value in distinct]
        else:
            edges = np.linspace(values.min(), values.max(), BINS + 1)
            place = np.clip(np.searchsorted(edges, values, "right") - 1, 0, BINS - 1)
            middles = 0.5 * (edges[1:] + edges[:-1])
            groups = [(middles[i], place == i) for i in range(BINS)]
        groups = [(x, mine) for x, mine in groups if mine.any()]
        x = np.array([x for x, _ in groups])
        share = np.array([success[mine].mean() for _, mine in groups])
        counts = [(int(success[mine].sum()), int(mine.sum())) for _, mine in groups]
        ends = np.array([share_interval(*count) for count in counts])
        error = np.abs(ends.T - share)
        axes.errorbar(x, share, error, fmt="o-", color=GOOD, ecolor=QUIET, capsize=3)
        axes.set_xlabel(path, fontsize=9)
        axes.set_ylabel("share of successes", fontsize=9)
        axes.set_ylim(-0.03, 1.03)
        axes.grid(color="#e4e7ea", linewidth=0.6)
    return figure


def _by_direction(campaign: Campaign, records: Records, path: str) -> Figure:
    """Draws polar plots: successes by sector; trials by size, or thresholds."""
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    rows = list(records.values())
    angles = _numbers(rows, path)
    success = np.array([row["success"] for row in rows], dtype=bool)
    left: Any = figure.add_subplot(1, 2, 1, projection="polar")
    width = 2.0 * np.pi / SECTORS
    sector = np.floor((angles + 0.5 * width) / width).astype(int) % SECTORS
    for index in range(SECTORS):
        mine = sector == index
        if mine.any():
            low, high = share_interval(int(success[mine].sum()), int(mine.sum()))
            middle = index * width
            left.bar(middle, success[mine].mean(), 0.9 * width, color=GOOD, alpha=0.6)
            left.plot([middle, middle], [low, high], color=QUIET)
    left.set_ylim(0.0, 1.0)
    left.set_title("share of successes", fontsize=9)
    right: Any = figure.add_subplot(1, 2, 2, projection="polar")
    if campaign.threshold is not None and path in campaign.cases:
        _draw_thresholds(right, campaign, records, path)
    else:
        size = path.removesuffix("direction") + "impulse"
        sizes = _numbers(rows, size)
        if len(sizes) != len(rows):
            sizes, size = np.ones(len(rows)), "trials"
        for good, color in ((True, GOOD), (False, BAD)):
            mine = success == good
            right.plot(angles[mine], sizes[mine], ".", color=color, alpha=0.7)
        right.set_title(f"{size}: green borne, red not", fontsize=9)
    for axes in (left, right):
        # Forward is up, and to the left is to the left.
        axes.set_theta_zero_location("N")
    return figure


def _draw_thresholds(
    axes: Any, campaign: Campaign, records: Records, path: str
) -> None:
    assert campaign.threshold is not None
    lines: dict[str, list[tuple[float, float]]] = {}
    for index in range(len(case_list(campaign))):
        found = Search(campaign, index).found(records)
        others = {k: v for k, v in found.case.items() if k != path}
        name = ", ".join(str(value) for value in others.values())
        lines.setdefault(name, []).append((float(found.case[path]), found.borne))
    for name, points in lines.items():
        points = sorted(points)
        closed = np.array([*points, points[0]])
        axes.plot(closed[:, 0], closed[:, 1], "o-", label=name or None)
    if any(lines):
        axes.legend(fontsize=8, loc="lower right")
    axes.set_title(f"{campaign.threshold.of}, largest borne", fontsize=9)


def _distributions(rows: list[Record]) -> Figure:
    """Draws a histogram of each figure, of successes and of failures."""
    names = figure_names(rows)
    figure, all_axes = _grid(len(names), 4)
    for axes, name in zip(all_axes, names, strict=True):
        good, bad = (
            figure_values([row for row in rows if row["success"] == wanted], name)
            for wanted in (True, False)
        )
        edges = _edges([*good, *bad])
        axes.hist([good, bad], bins=edges, stacked=True, color=[GOOD, BAD])
        axes.set_title(name, fontsize=9, loc="left")
        axes.tick_params(labelsize=8)
    return figure


def _edges(values: list[float]) -> np.ndarray:
    """Returns edges of bins that differ even if the values hardly do."""
    low, high = min(values), max(values)
    width = max(high - low, RELATIVE_WIDTH * max(abs(low), abs(high))) or 1.0
    middle = low + 0.5 * (high - low)
    return np.linspace(middle - 0.5 * width, middle + 0.5 * width, HISTOGRAM_BINS + 1)
