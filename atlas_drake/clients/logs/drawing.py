"""Parts of the figures of a log: what every figure of matplotlib has here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from atlas_drake.clients.logs.footprints import runs
from atlas_drake.clients.logs.log import Log
from atlas_drake.messages.event import PUSH
from atlas_drake.palette import Color

WIDTH = 15.0
"""Width of a page [inch]."""
HEADER, GAP, FOOTER = 1.05, 0.72, 0.55
"""Space above the first row, between rows, below the last row [inch]."""
LEFT, MIDDLE, RIGHT = 0.95, 1.35, 0.75
"""Space beside and between the columns [inch]."""
MAP_COLUMNS = 1200
"""Columns of a map of all joints: about two for each pixel."""
SMALL, TINY = 8, 6.5
"""Size of letters [point]."""
NARROW_SPAN = 0.018
"""Width of one letter of a span's name, as a share of the page's time [-]."""
ALARM = "#d50000"
STYLE: Any = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": SMALL,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "grid.color": "#e4e7ea",
    "grid.linewidth": 0.6,
    "legend.borderaxespad": 0.0,
    "legend.columnspacing": 1.0,
    "legend.fontsize": SMALL,
    "legend.frameon": False,
    "legend.handlelength": 1.2,
    "legend.handletextpad": 0.4,
    "text.parse_math": False,  # A $ in a name starts no formula.
    "xtick.labelsize": SMALL,
    "xtick.major.size": 2.5,
    "ytick.labelsize": SMALL,
    "ytick.major.size": 2.5,
}
"""Settings of matplotlib under which figures are drawn."""


def titled_figure(log: Log, height: float) -> Figure:
    """Returns a figure with title and subtitle."""
    figure, time = Figure(figsize=(WIDTH, height)), log.time
    left, top = LEFT / WIDTH, 1.0 - 0.32 / height
    # The name alone: another version may not know all of the scenario.
    scenario = log.header.scenario.get("name", "without a name")
    title = f"{log.path.name}: {log.header.model}, scenario {scenario}"
    figure.text(left, top, title, fontsize=14, weight="bold", va="center")
    period = 1e3 * log.header.control_period
    ticks = f"{len(log)} control ticks of {period:g} ms"
    subtitle = f"{time[0]:.1f} s to {time[-1]:.1f} s, {ticks}"
    figure.text(left, top - 0.26 / height, subtitle, fontsize=10, va="center")
    return figure


MARKED = {"fall": ALARM, PUSH: "#b26a00"}
"""Colors of the lines at events of these kinds."""


def over_time(axes: Any, log: Log) -> None:
    """Gives a figure the time of the log, with a named line at each push and fall."""
    # The last row is valid for one more period.
    axes.set_xlim(log.time[0], log.time[-1] + log.header.control_period)
    axes.set_xlabel("time [s]", labelpad=1)
    for event in log.events:
        if event.kind in MARKED:
            color = MARKED[event.kind]
            axes.axvline(event.time, color=color, lw=1.0, zorder=3, label="_event")
            axes.annotate(
                event.kind,
                xy=(event.time, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(2, -1),
                textcoords="offset points",
                annotation_clip=True,
                va="top",
                color=color,
                fontsize=TINY,
            )


def draw_curve(
    axes: Any,
    x: np.ndarray,
    y: np.ndarray,
    color: str | Color,
    label: str = "",
    *,
    dashed: bool = False,
    width: float = 1.1,
) -> None:
    """Draws a curve, with gaps where y is NaN."""
    style = (0, (3, 2)) if dashed else "-"
    axes.plot(x, y, color=color, lw=width, ls=style, label=label or None)


def draw_outline(
    axes: Any,
    corners: np.ndarray,
    color: str | Color,
    label: str = "",
    opacity: float = 0.0,
) -> None:
    """Draws a polygon with corners of shape (any, 2), filled or dashed."""
    x, y = np.vstack([corners, corners[:1]]).T
    if opacity:
        axes.fill(x, y, color=color, alpha=opacity, lw=0.0, label=label or None)
    axes.plot(x, y, color=color, lw=0.8, ls="-" if opacity else (0, (2, 2)))


def draw_spans(axes: Any, log: Log, flags: np.ndarray, color: str, label: str) -> None:
    """Draws the intervals in which flags, shape (rows,), are set, and their name."""
    axes.set_xlabel("")
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.grid(visible=False)
    first, last = axes.get_xlim()
    for begin, end in runs(flags):
        start, stop = log.time[begin], log.time[min(end, len(log) - 1)]
        axes.axvspan(start, stop, color=color, lw=0.0, label=f"_{label}")
        if (stop - start) / (last - first) > NARROW_SPAN * len(label):
            middle = 0.5 * (start + stop), 0.5
            axes.text(*middle, label, fontsize=SMALL, ha="center", va="center")


def draw_map(
    axes: Any,
    log: Log,
    values: np.ndarray,
    high: float,
    colors: Sequence[str],
    label: str,
) -> None:
    """Draws numbers of all joints, shape (rows, joints), as colors from 0 to ``high``.

    Of rows that share a pixel it shows the highest value.
    """
    names = log.robot.joint_names
    starts = np.arange(0, len(log), -(-len(log) // MAP_COLUMNS))
    image = axes.imshow(
        np.maximum.reduceat(values, starts, axis=0).T,
        aspect="auto",
        interpolation="nearest",
        cmap=LinearSegmentedColormap.from_list("map", colors),
        vmin=0.0,
        vmax=high,
        extent=(*axes.get_xlim(), len(names) - 0.5, -0.5),
    )
    axes.set_yticks(range(len(names)), names, fontsize=TINY)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False)
    bar = axes.inset_axes((1.012, 0.0, 0.014, 1.0))
    bar.grid(visible=False)
    axes.figure.colorbar(image, cax=bar)
    bar.tick_params(labelsize=TINY, length=2)
    bar.set_ylabel(label, fontsize=TINY + 0.5, labelpad=2)
