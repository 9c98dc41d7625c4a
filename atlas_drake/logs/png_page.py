"""Draws a page of figures as a picture, with matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from PIL import Image

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
SWATCH = 10
"""Size of each color in the strip that shapes the palette [pixel]."""
COLORS = 256
"""Number of colors of the palette: reduces the file by two thirds without a visible
difference."""
COLUMNS = 1200
"""Columns of a map: about two for each pixel."""
SMALL, TINY = 8, 6.5
"""Size of letters [point]."""


@rc_context({"text.parse_math": False})  # A $ in a name starts no formula.
def draw_figure(page: Page) -> Figure:
    """Draws the page as a figure of matplotlib."""
    gaps = GAP * (len(page.heights) - 1)
    height = HEADER + sum(page.heights) + gaps + FOOTER
    figure = Figure(figsize=(WIDTH, height), dpi=DPI)
    FigureCanvasAgg(figure)
    left, top = LEFT / WIDTH, 1.0 - 0.32 / height
    figure.text(left, top, page.title, fontsize=14, weight="bold", va="center")
    figure.text(left, top - 0.26 / height, page.subtitle, fontsize=10, va="center")
    column = (WIDTH - LEFT - RIGHT - MIDDLE * (page.columns - 1)) / page.columns
    for panel in page.panels:
        above = HEADER + sum(page.heights[: panel.row]) + GAP * panel.row
        own = page.heights[panel.row : panel.row + panel.rows]
        tall = sum(own) + GAP * (len(own) - 1)
        x = LEFT + panel.column * (column + MIDDLE)
        place = (
            x / WIDTH,
            1.0 - (above + tall) / height,
            column / WIDTH,
            tall / height,
        )
        _draw_panel(figure.add_axes(place, label=panel.title), panel, page)
    return figure


def write_png(page: Page, path: Path) -> None:
    """Writes the page as a picture."""
    figure = draw_figure(page)
    canvas: Any = figure.canvas
    canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    _with_palette(picture, page).save(path, format="png", optimize=True)


def _with_palette(picture: Image.Image, page: Page) -> Image.Image:
    """Reduces the picture to few colors, among them the colors of thin lines.

    The palette consists of the frequent colors. A strip below the picture makes the
    colors of the lines frequent.
    """
    colors = sorted(
        {item.color for panel in page.panels for item in panel.items if _thin(item)}
    )
    width, height = picture.size
    strip = SWATCH * len(colors)
    longer = Image.new("RGB", (width, height + strip), "white")
    longer.paste(picture, (0, 0))
    for number, color in enumerate(colors):
        top = height + SWATCH * number
        longer.paste(color, (0, top, width, top + SWATCH))
    return longer.quantize(COLORS).crop((0, 0, width, height))


def _thin(item: Item) -> TypeGuard[Line | Marker]:
    return isinstance(item, Line | Marker)


def _draw_panel(axes: Any, panel: Panel, page: Page) -> None:
    axes.set_title(panel.title, fontsize=10, loc="left")
    axes.set_xlabel(panel.x_label, fontsize=SMALL, labelpad=1)
    axes.set_ylabel(panel.y_label, fontsize=SMALL)
    axes.tick_params(labelsize=SMALL, length=2.5)
    axes.grid(visible=True, color="#e4e7ea", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if panel.over_time:
        axes.set_xlim(page.time)
    for item in panel.items:
        _DRAW[type(item)](axes, item, page)
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


def _line(axes: Any, item: Line, _page: Page) -> None:
    style = (0, (3, 2)) if item.dashed else "-"
    axes.plot(
        item.x,
        item.y,
        color=item.color,
        linewidth=item.width,
        linestyle=style,
        label=item.label or None,
    )


def _band(axes: Any, item: Band, _page: Page) -> None:
    axes.fill_between(
        item.x,
        item.low,
        item.high,
        color=item.color,
        alpha=0.55,
        linewidth=0.0,
        label=item.label or None,
    )


def _outline(axes: Any, item: Outline, _page: Page) -> None:
    x, y = item.closed
    if item.opacity:
        axes.fill(
            x,
            y,
            color=item.color,
            alpha=item.opacity,
            linewidth=0.0,
            label=item.label or None,
        )
    style = (0, (2, 2)) if item.dashed else "-"
    axes.plot(x, y, color=item.color, linewidth=0.8, linestyle=style)


def _span(axes: Any, item: Span, page: Page) -> None:
    axes.axvspan(item.start, item.end, color=item.color, linewidth=0.0)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.grid(visible=False)
    if page.has_room(item):
        axes.text(
            0.5 * (item.start + item.end),
            0.5,
            item.label,
            fontsize=SMALL,
            ha="center",
            va="center",
        )


def _marker(axes: Any, item: Marker, _page: Page) -> None:
    axes.axvline(item.x, color=item.color, linewidth=1.0)


def _heat(axes: Any, item: Heat, page: Page) -> None:
    colors = LinearSegmentedColormap.from_list("heat", item.colors)
    rows = len(item.names)
    image = axes.imshow(
        item.thinned(COLUMNS)[1],
        aspect="auto",
        interpolation="nearest",
        cmap=colors,
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


_DRAW: dict[type, Callable[[Any, Any, Page], None]] = {
    Line: _line,
    Band: _band,
    Outline: _outline,
    Span: _span,
    Marker: _marker,
    Heat: _heat,
}
