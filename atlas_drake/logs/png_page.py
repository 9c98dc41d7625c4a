"""Draws a page of figures as a picture, with matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from atlas_drake.logs.panels import (
    Band,
    Heat,
    Item,
    Line,
    Marker,
    Outline,
    Page,
    Panel,
    Span,
)

WIDTH = 15.0
"""Width of the page [inch]."""
HEADER, GAP, FOOTER = 1.05, 0.72, 0.55
"""Space above the first row, between rows, below the last row [inch]."""
LEFT, MIDDLE, RIGHT = 0.95, 1.35, 0.75
"""Space beside and between the columns [inch]."""
DPI = 100
COLUMNS = 1200
"""Columns of a map: about two for each pixel."""
SMALL, TINY = 8, 6.5
"""Size of letters [point]."""


@rc_context({"text.parse_math": False})  # A $ in a name starts no formula.
def draw_figure(page: Page) -> Figure:
    """Draws the page as a figure of matplotlib."""
    rows, columns = len(page.heights), page.columns
    height = HEADER + sum(page.heights) + GAP * (rows - 1) + FOOTER
    width = (WIDTH - LEFT - RIGHT - MIDDLE * (columns - 1)) / columns
    figure = Figure(figsize=(WIDTH, height), dpi=DPI)
    left, top = LEFT / WIDTH, 1.0 - 0.32 / height
    figure.text(left, top, page.title, fontsize=14, weight="bold", va="center")
    figure.text(left, top - 0.26 / height, page.subtitle, fontsize=10, va="center")
    grid = figure.add_gridspec(
        rows,
        columns,
        height_ratios=page.heights,
        left=left,
        right=1.0 - RIGHT / WIDTH,
        top=1.0 - HEADER / height,
        bottom=FOOTER / height,
        # As shares of a mean row and of a column.
        hspace=GAP * rows / sum(page.heights),
        wspace=MIDDLE / width,
    )
    for panel in page.panels:
        place = grid[panel.row : panel.row + panel.rows, panel.column]
        _draw_panel(figure.add_subplot(place), panel, page)
    return figure


def write_png(page: Page, path: Path) -> None:
    """Writes the page as a picture."""
    draw_figure(page).savefig(path, format="png")


def _draw_panel(axes: Any, panel: Panel, page: Page) -> None:
    axes.set_title(panel.title, fontsize=10, loc="left")
    axes.set_xlabel(panel.x_label, fontsize=SMALL, labelpad=1)
    axes.set_ylabel(panel.y_label, fontsize=SMALL)
    axes.tick_params(labelsize=SMALL, length=2.5)
    axes.grid(visible=True, color="#e4e7ea", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    if panel.over_time:
        axes.set_xlim(page.time)
    for item in panel.items:
        _draw(axes, item, page)
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.04)
    if panel.y_range is not None:
        axes.set_ylim(panel.y_range)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.01, 0.985),
            ncol=8,
            fontsize=SMALL,
            frameon=False,
            handlelength=1.2,
            handletextpad=0.4,
            columnspacing=1.0,
            borderaxespad=0.0,
        )


def _draw(axes: Any, item: Item, page: Page) -> None:
    match item:
        case Line(x, y, color, label, dashed, width):
            style = (0, (3, 2)) if dashed else "-"
            axes.plot(x, y, color=color, lw=width, ls=style, label=label or None)
        case Band(x, low, high, color, label):
            axes.fill_between(
                x, low, high, color=color, alpha=0.55, lw=0.0, label=label or None
            )
        case Outline(_, color, label, opacity, dashed):
            x, y = item.closed
            if opacity:
                axes.fill(x, y, color=color, alpha=opacity, lw=0.0, label=label or None)
            style = (0, (2, 2)) if dashed else "-"
            axes.plot(x, y, color=color, lw=0.8, ls=style)
        case Marker(x, color):
            axes.axvline(x, color=color, lw=1.0)
        case Span(start, end, color, label):
            axes.axvspan(start, end, color=color, lw=0.0)
            axes.set_yticks([])
            axes.spines["left"].set_visible(False)
            axes.grid(visible=False)
            if page.has_room(item):
                axes.text(
                    *(0.5 * (start + end), 0.5, label),
                    fontsize=SMALL,
                    ha="center",
                    va="center",
                )
        case Heat():
            _draw_heat(axes, item, page)


def _draw_heat(axes: Any, item: Heat, page: Page) -> None:
    rows = len(item.names)
    image = axes.imshow(
        item.thinned(COLUMNS)[1],
        aspect="auto",
        interpolation="nearest",
        cmap=LinearSegmentedColormap.from_list("heat", item.colors),
        vmin=item.low,
        vmax=item.high,
        extent=(*page.time, rows - 0.5, -0.5),
    )
    axes.set_yticks(range(rows), item.names, fontsize=TINY)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False)
    bar = axes.inset_axes((1.012, 0.0, 0.014, 1.0))
    axes.figure.colorbar(image, cax=bar)
    bar.tick_params(labelsize=TINY, length=2)
    bar.set_ylabel(item.label, fontsize=TINY + 0.5, labelpad=2)
