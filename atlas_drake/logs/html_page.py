"""Draws a page of figures as one interactive web page, with plotly.

The page is self-contained; its security policy forbids it to load anything.
"""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from plotly.subplots import make_subplots

from atlas_drake.logs.balance_figures import runs
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
    thinned,
)

POINTS = 2400
"""Approximate number of points of a curve, or columns of a map, that are kept."""
PIXELS_PER_INCH = 92
HEADER, GAP, FOOTER = 132, 110, 60
"""Space above the first row, between rows, below the last row [pixel]."""
TITLE_ABOVE = 34
"""Height of a panel's title above the panel [pixel]: up to two lines of a legend fit
between them, however narrow the page is."""
GAP_BETWEEN_COLUMNS = 0.09
"""Gap between columns as a share of the page's width."""
SMALL_STEP = 1e-3
"""Changes of a band's edges below this are not drawn, in units of y."""
BAR_WIDTH = 10
"""Size of color scales [pixel]."""
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; font-src data:"
)
"""Content-Security-Policy of the page: nothing is loaded from anywhere."""


def write_html(page: Page, path: Path) -> None:
    """Writes the page; any browser shows it, also without a network."""
    html = draw(page).to_html(
        include_plotlyjs=True,
        config={"displaylogo": False, "responsive": True, "plotlyServerURL": ""},
    )
    head = (
        f'<head><meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        f"<title>{escape(page.title)}</title>"
    )
    path.write_text(html.replace("<head>", head, 1), encoding="utf-8")


def draw(page: Page) -> Any:
    """Draws the page as a figure of plotly."""
    rows = len(page.heights)
    inner = PIXELS_PER_INCH * sum(page.heights) + GAP * (rows - 1)
    specs: list[list[Any]] = [[{}] * page.columns for _ in range(rows)]
    for panel in page.panels:
        specs[panel.row][panel.column] = {"rowspan": panel.rows}
        for row in range(panel.row + 1, panel.row + panel.rows):
            specs[row][panel.column] = None
    figure = make_subplots(
        rows=rows,
        cols=page.columns,
        specs=specs,
        row_heights=[*page.heights],
        vertical_spacing=GAP / inner,
        horizontal_spacing=GAP_BETWEEN_COLUMNS,
    )
    figure.update_layout(
        template="plotly_white",
        height=round(inner + HEADER + FOOTER),
        margin={"t": HEADER, "b": FOOTER, "l": 90, "r": 70},
        title={
            "text": f"<b>{escape(page.title)}</b><br>{escape(page.subtitle)}",
            "font": {"size": 16},
            "y": 1.0 - 40 / (inner + HEADER + FOOTER),
        },
        hovermode="closest",
        font={"size": 11},
    )
    for number, panel in enumerate(page.panels):
        _draw_panel(figure, panel, page, "" if number == 0 else str(number + 1))
    return figure


def _draw_panel(figure: Any, panel: Panel, page: Page, suffix: str) -> None:
    cell = {"row": panel.row + 1, "col": panel.column + 1}
    x, y = figure.get_subplot(**cell)
    x.title = {"text": panel.x_label, "standoff": 4}
    y.title = {"text": panel.y_label, "standoff": 4}
    if panel.over_time:
        x.range = page.time
        if suffix:
            x.matches = "x"
    if panel.y_range is not None:
        y.range = panel.y_range
    if panel.equal:
        y.scaleanchor, y.scaleratio = y.anchor, 1.0
    corner = {"x": x.domain[0], "y": y.domain[1]}
    corner |= {"xanchor": "left", "yanchor": "bottom"}
    legend = f"legend{suffix}"
    figure.layout[legend] = {
        **corner,
        "orientation": "h",
        "font": {"size": 10},
        "bgcolor": "rgba(0,0,0,0)",
        "itemwidth": 30,
    }
    figure.add_annotation(
        **corner,
        text=f"<b>{escape(panel.title)}</b>",
        xref="paper",
        yref="paper",
        yshift=TITLE_ABOVE,
        showarrow=False,
        font={"size": 12},
    )
    for item in panel.items:
        _draw(figure, item, page, {**cell, "legend": legend})


def _draw(figure: Any, item: Item, page: Page, at: dict[str, Any]) -> None:
    """Draws an item in a cell of the grid, with a legend of its own."""
    cell = {"row": at["row"], "col": at["col"]}
    match item:
        case Line(_, _, color, label, dashed, width):
            x, y = _thin_track(item)
            dash = "dash" if dashed else "solid"
            line = {"color": color, "width": 1.2 * width, "dash": dash}
            _add_curve(figure, at, label, x=x, y=y, line=line)
        case Band(color=color, label=label):
            x, y = _band_polygons(item)
            fill = {"fillcolor": _transparent(color, 0.55), "hoverinfo": "skip"}
            edge = {"width": 0}
            _add_curve(figure, at, label, x=x, y=y, line=edge, fill="toself", **fill)
        case Outline(_, color, label, opacity, dashed):
            x, y = item.closed
            dash = "dash" if dashed else "solid"
            line = {"color": color, "width": 1, "dash": dash}
            fill = {"fillcolor": _transparent(color, opacity), "hoverinfo": "skip"}
            kind = "toself" if opacity else None
            _add_curve(figure, at, label, x=x, y=y, line=line, fill=kind, **fill)
        case Marker(x, color):
            figure.add_vline(x=x, line={"color": color, "width": 1}, **cell)
        case Span(start, end, color, label):
            _add_curve(
                figure,
                at,
                x=[start, start, end, end, start],
                y=[0, 1, 1, 0, 0],
                line={"color": color, "width": 1},
                fill="toself",
                fillcolor=color,
                hoveron="fills",
                hoverinfo="text",
                text=f"{label}: {start:.2f} s to {end:.2f} s",
            )
            figure.update_yaxes(visible=False, range=(0, 1), **cell)
            if page.has_room(item):
                figure.add_annotation(
                    text=escape(label),
                    x=0.5 * (start + end),
                    y=0.5,
                    showarrow=False,
                    font={"size": 10},
                    **cell,
                )
        case Heat():
            _draw_heat(figure, item, cell)


def _add_curve(
    figure: Any, at: dict[str, Any], label: str = "", **options: Any
) -> None:
    figure.add_scatter(
        mode="lines", name=label or None, showlegend=bool(label), **options, **at
    )


def _thin_track(item: Line) -> tuple[np.ndarray, np.ndarray]:
    if (np.diff(item.x) >= 0.0).all():
        x, y = thinned(item.x, item.y, POINTS)
    else:
        # Thinning by extremes does not apply to a track in the plane.
        every = slice(None, None, -(-len(item.x) // POINTS))
        x, y = item.x[every], item.y[every]
    return np.round(x, 5), y.astype(np.float32)


def _band_polygons(item: Band) -> tuple[np.ndarray, np.ndarray]:
    """Outlines of the pieces of a band, with gaps between them."""
    gap = np.full(1, np.nan)
    xs, ys = [gap], [gap]
    for begin, end in runs(~np.isnan(item.low)):
        x, low, high = (a[begin:end] for a in (item.x, item.low, item.high))
        # The edges are step functions: only their corners are drawn.
        moved = np.hypot(np.diff(low), np.diff(high)) > SMALL_STEP
        corner = np.r_[moved, True] | np.r_[True, moved]
        x, low, high = x[corner], low[corner], high[corner]
        xs += [x, x[::-1], gap]
        ys += [low, high[::-1], gap]
    return np.round(np.concatenate(xs), 5), np.concatenate(ys).astype(np.float32)


def _draw_heat(figure: Any, item: Heat, cell: dict[str, int]) -> None:
    x, z = item.thinned(POINTS)
    plot = figure.get_subplot(**cell)
    low, high = plot.yaxis.domain
    count = len(item.colors) - 1
    figure.add_heatmap(
        x=np.round(x, 5),
        y=list(item.names),
        z=z.astype(np.float32),
        zmin=item.low,
        zmax=item.high,
        colorscale=[[i / count, color] for i, color in enumerate(item.colors)],
        colorbar={
            "title": {"text": item.label, "side": "right", "font": {"size": 10}},
            "x": plot.xaxis.domain[1] + 0.004,
            "xanchor": "left",
            "y": 0.5 * (low + high),
            "len": high - low,
            "thickness": BAR_WIDTH,
            "xpad": 0,
            "ypad": 0,
            "tickfont": {"size": 9},
        },
        hovertemplate="%{y} at %{x:.3f} s: %{z:.3g}<extra></extra>",
        **cell,
    )
    figure.update_yaxes(autorange="reversed", dtick=1, tickfont={"size": 8}, **cell)


def _transparent(color: str, opacity: float) -> str:
    return f"{color}{round(255 * opacity):02x}"
