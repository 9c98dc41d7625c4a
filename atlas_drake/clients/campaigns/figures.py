"""Figures of a campaign's results: success by value and direction, distributions.

Needs matplotlib.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from atlas_drake.atomic_write import atomic_write
from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.clients.campaigns.plan import Records, Search, case_list
from atlas_drake.clients.campaigns.table import (
    FIGURES,
    VALUES,
    case_label,
    numeric_figures,
    share_interval,
    table_of,
)

if TYPE_CHECKING:
    import pandas as pd

BINS, SECTORS, HISTOGRAM_BINS = 8, 12, 20
"""Numbers of groups of trials, by a value, by a direction and by a figure."""
RELATIVE_WIDTH = 1e-9
"""Smallest width of a histogram, as a share of its values [-]."""
DPI = 110
GOOD, BAD, QUIET = "#2a7f62", "#c0392b", "#5b6770"
"""Colors of successes, of failures, and of what is neither."""


def write_figures(campaign: Campaign, records: Records, folder: Path) -> list[Path]:
    """Draws every figure for which the results have numbers; returns their paths."""
    frame = table_of(records)
    varied = frame.filter(regex=f"^{VALUES}").select_dtypes("number").dropna(axis=1)
    angles = [name for name in varied if name.endswith("direction")]
    sizes = [name for name in varied if name not in angles]
    pages: dict[str, Figure] = {}
    if sizes:
        pages["success_by_value.png"] = _by_value(frame, sizes)
    if angles:
        pages["success_by_direction.png"] = _by_direction(
            campaign, records, frame, angles[0].removeprefix(VALUES)
        )
    if numeric_figures(frame):
        pages["distributions.png"] = _distributions(frame)
    for name, figure in pages.items():
        figure.suptitle(f"{campaign.name}, {len(frame)} trials", fontsize=11)
        with atomic_write(folder / name) as unfinished:
            figure.savefig(unfinished, dpi=DPI)
    return [folder / name for name in pages]


def _grid(count: int, across: int) -> tuple[Figure, list[Any]]:
    """Makes a figure with ``count`` axes."""
    across = min(count, across)
    down = -(-count // across)
    figure = Figure(figsize=(4.2 * across, 3.1 * down + 0.3), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(down, across, squeeze=False).ravel().tolist()
    for unused in axes[count:]:
        unused.set_visible(False)
    return figure, axes[:count]


def _by_value(frame: pd.DataFrame, columns: list[str]) -> Figure:
    """Draws the share of successes over each value, with Wilson's intervals."""
    figure, all_axes = _grid(len(columns), 3)
    for axes, column in zip(all_axes, columns, strict=True):
        values = frame[column].astype(float)
        if values.nunique() > BINS:
            edges = np.linspace(values.min(), values.max(), BINS + 1)
            middles = 0.5 * (edges[1:] + edges[:-1])
            place = np.searchsorted(edges, values, "right") - 1
            values = middles[np.clip(place, 0, BINS - 1)]
        groups = frame["success"].groupby(values)
        x, share = list(groups.groups), groups.mean().astype(float)
        ends = [share_interval(int(mine.sum()), len(mine)) for _, mine in groups]
        error = np.abs(np.transpose(ends) - share.to_numpy())
        axes.errorbar(x, share, error, fmt="o-", color=GOOD, ecolor=QUIET, capsize=3)
        axes.set_xlabel(column.removeprefix(VALUES), fontsize=9)
        axes.set_ylabel("share of successes", fontsize=9)
        axes.set_ylim(-0.03, 1.03)
        axes.grid(color="#e4e7ea", linewidth=0.6)
    return figure


def _by_direction(
    campaign: Campaign, records: Records, frame: pd.DataFrame, path: str
) -> Figure:
    """Draws polar plots: successes by sector; trials by size, or thresholds."""
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, subplot_kw={"projection": "polar"})
    angles = frame[VALUES + path].to_numpy(dtype=float)
    width = 2.0 * np.pi / SECTORS
    sector = np.floor((angles + 0.5 * width) / width).astype(int) % SECTORS
    for index, mine in frame["success"].groupby(sector):
        middle = index * width
        left.bar(middle, mine.mean(), 0.9 * width, color=GOOD, alpha=0.6)
        ends = share_interval(int(mine.sum()), len(mine))
        left.plot([middle, middle], ends, color=QUIET)
    left.set_ylim(0.0, 1.0)
    left.set_title("share of successes", fontsize=9)
    if campaign.threshold is not None and path in campaign.cases:
        _draw_thresholds(right, campaign, records, path)
    else:
        size = path.removesuffix("direction") + "impulse"
        sizes = frame.get(VALUES + size, np.ones(len(frame)))
        for good, color in ((True, GOOD), (False, BAD)):
            mine = (frame["success"] == good).to_numpy(dtype=bool)
            right.plot(angles[mine], sizes[mine], ".", color=color, alpha=0.7)
        right.set_title(f"{size}: green passed, red failed", fontsize=9)
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
        found = Search(campaign, index, records)
        others = {k: v for k, v in found.case.items() if k != path}
        point = (float(found.case[path]), found.passed)
        lines.setdefault(case_label(others), []).append(point)
    for name, points in lines.items():
        closed = np.array([*sorted(points), min(points)])
        axes.plot(closed[:, 0], closed[:, 1], "o-", label=name)
    axes.legend(fontsize=8, loc="lower right")
    axes.set_title(f"{campaign.threshold.of}, highest passed", fontsize=9)


def _distributions(frame: pd.DataFrame) -> Figure:
    """Draws a histogram of each figure, of successes and of failures."""
    columns = numeric_figures(frame)
    figure, all_axes = _grid(len(columns), 4)
    success = frame["success"].astype(bool)
    for axes, column in zip(all_axes, columns, strict=True):
        values = frame[column].astype(float).dropna()
        good, bad = values[success[values.index]], values[~success[values.index]]
        edges = _edges(values.min(), values.max())
        axes.hist([good, bad], bins=edges, stacked=True, color=[GOOD, BAD])
        axes.set_title(column.removeprefix(FIGURES), fontsize=9, loc="left")
        axes.tick_params(labelsize=8)
    return figure


def _edges(low: float, high: float) -> np.ndarray:
    """Returns edges of bins that differ even if the values hardly do."""
    width = max(high - low, RELATIVE_WIDTH * max(abs(low), abs(high))) or 1.0
    middle = low + 0.5 * (high - low)
    return np.linspace(middle - 0.5 * width, middle + 0.5 * width, HISTOGRAM_BINS + 1)
