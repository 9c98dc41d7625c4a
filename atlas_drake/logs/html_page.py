"""Draws a page of figures as one interactive web page, with plotly.

The page is self-contained; its security policy forbids it to load anything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from atlas_drake.logs.panels import (
    Band,
    Heat,
    Line,
    Marker,
    Outline,
    Page,
    Panel,
    Span,
    thinned,
)
from atlas_drake.logs.support import runs

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


@dataclass(frozen=True)
class _Place:
    """Place of an item: the page, a cell of its grid, and a legend."""

    page: Page
    cell: dict[str, int]
    legend: str


def write_html(page: Page, path: Path) -> None:
    """Writes the page; any browser shows it, also without a network."""
    html = draw(page).to_html(
        include_plotlyjs=True,
        config={"displaylogo": False, "responsive": True, "plotlyServerURL": ""},
    )
    head = (
        f'<head><meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        f"<title>{_escaped(page.title)}</title>"
    )
    path.write_text(html.replace("<head>", head, 1), encoding="utf-8")


def draw(page: Page) -> Any:
    """Draws the page as a figure of plotly."""
    rows = len(page.heights)
    inner = PIXELS_PER_INCH * sum(page.heights) + GAP * (rows - 1)
    specs: list[list[Any]] = [[{}] * page.columns for _ in range(rows)]
    for panel in page.panels:
        column = panel.column
        specs[panel.row][column] = {"rowspan": panel.rows}
        for row in range(panel.row + 1, panel.row + panel.rows):
            specs[row][column] = None
    figure = make_subplots(
        rows=rows,
        cols=page.columns,
        specs=specs,
        row_heights=[height / sum(page.heights) for height in page.heights],
        vertical_spacing=GAP / inner,
        horizontal_spacing=GAP_BETWEEN_COLUMNS,
    )
    figure.update_layout(
        template="plotly_white",
        height=round(inner + HEADER + FOOTER),
        margin={"t": HEADER, "b": FOOTER, "l": 90, "r": 70},
        title={
            "text": f"<b>{_escaped(page.title)}</b><br>{_escaped(page.subtitle)}",
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
    plot = figure.get_subplot(panel.row + 1, panel.column + 1)
    x, y = plot.xaxis, plot.yaxis
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
    left = x.domain[0]
    top = y.domain[1]
    legend = f"legend{suffix}"
    figure.update_layout(
        {
            legend: {
                "orientation": "h",
                "x": left,
                "xanchor": "left",
                "y": top,
                "yanchor": "bottom",
                "font": {"size": 10},
                "bgcolor": "rgba(0,0,0,0)",
                "itemwidth": 30,
            }
        }
    )
    figure.add_annotation(
        text=f"<b>{_escaped(panel.title)}</b>",
        x=left,
        y=top,
        xref="paper",
        yref="paper",
        xanchor="left",
        yanchor="bottom",
        yshift=TITLE_ABOVE,
        showarrow=False,
        font={"size": 12},
    )
    at = _Place(page, {"row": panel.row + 1, "col": panel.column + 1}, legend)
    for item in panel.items:
        _DRAW[type(item)](figure, item, at)


def _line(figure: Any, item: Line, at: _Place) -> None:
    x, y = _thin_track(item)
    dash = "dash" if item.dashed else "solid"
    _add_scatter(
        figure,
        at,
        item.label,
        x=x,
        y=y,
        mode="lines",
        line={"color": item.color, "width": 1.2 * item.width, "dash": dash},
    )


def _thin_track(item: Line) -> tuple[np.ndarray, np.ndarray]:
    if (np.diff(item.x) >= 0.0).all():
        x, y = thinned(item.x, item.y, POINTS)
    else:
        # Thinning by extremes does not apply to a track in the plane.
        every = slice(None, None, -(-len(item.x) // POINTS))
        x, y = item.x[every], item.y[every]
    return np.round(x, 5), y.astype(np.float32)


def _band(figure: Any, item: Band, at: _Place) -> None:
    x, y = _band_polygons(item)
    _add_scatter(
        figure,
        at,
        item.label,
        x=np.round(x, 5),
        y=y.astype(np.float32),
        mode="lines",
        line={"width": 0},
        fill="toself",
        fillcolor=_transparent(item.color, 0.55),
        hoverinfo="skip",
    )


def _band_polygons(item: Band) -> tuple[np.ndarray, np.ndarray]:
    """Outlines of the pieces of a band, with gaps between them."""
    xs, ys = [np.full(1, np.nan)], [np.full(1, np.nan)]
    for begin, end in runs(~np.isnan(item.low)):
        x, low, high = (a[begin:end] for a in (item.x, item.low, item.high))
        # The edges are step functions: only their corners are drawn.
        moved = np.hypot(np.diff(low), np.diff(high)) > SMALL_STEP
        corner = np.r_[moved, True] | np.r_[True, moved]
        x, low, high = x[corner], low[corner], high[corner]
        xs += [x, x[::-1], np.full(1, np.nan)]
        ys += [low, high[::-1], np.full(1, np.nan)]
    return np.concatenate(xs), np.concatenate(ys)


def _outline(figure: Any, item: Outline, at: _Place) -> None:
    dash = "dash" if item.dashed else "solid"
    _add_scatter(
        figure,
        at,
        item.label,
        x=item.closed[0],
        y=item.closed[1],
        mode="lines",
        line={"color": item.color, "width": 1, "dash": dash},
        fill="toself" if item.opacity else None,
        fillcolor=_transparent(item.color, item.opacity),
        hoverinfo="skip",
    )


def _span(figure: Any, item: Span, at: _Place) -> None:
    _add_scatter(
        figure,
        at,
        "",
        x=[item.start, item.start, item.end, item.end, item.start],
        y=[0, 1, 1, 0, 0],
        mode="lines",
        line={"color": item.color, "width": 1},
        fill="toself",
        fillcolor=item.color,
        hoveron="fills",
        hoverinfo="text",
        text=f"{item.label}: {item.start:.2f} s to {item.end:.2f} s",
    )
    figure.update_yaxes(visible=False, range=(0, 1), **at.cell)
    if at.page.has_room(item):
        figure.add_annotation(
            text=_escaped(item.label),
            x=0.5 * (item.start + item.end),
            y=0.5,
            showarrow=False,
            font={"size": 10},
            **at.cell,
        )


def _marker(figure: Any, item: Marker, at: _Place) -> None:
    figure.add_vline(x=item.x, line={"color": item.color, "width": 1}, **at.cell)


def _heat(figure: Any, item: Heat, at: _Place) -> None:
    x, z = item.thinned(POINTS)
    plot = figure.get_subplot(**at.cell)
    low, high = plot.yaxis.domain
    count = len(item.colors) - 1
    figure.add_trace(
        go.Heatmap(
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
        ),
        **at.cell,
    )
    figure.update_yaxes(autorange="reversed", dtick=1, tickfont={"size": 8}, **at.cell)


def _add_scatter(figure: Any, at: _Place, label: str, **options: Any) -> None:
    options.setdefault("hovertemplate", None)
    figure.add_trace(
        go.Scatter(
            name=label or None,
            legend=at.legend,
            showlegend=bool(label),
            connectgaps=False,
            **options,
        ),
        **at.cell,
    )


def _transparent(color: str, opacity: float) -> str:
    red, green, blue = (int(color[place : place + 2], 16) for place in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


_DRAW: dict[type, Callable[[Any, Any, _Place], None]] = {
    Line: _line,
    Band: _band,
    Outline: _outline,
    Span: _span,
    Marker: _marker,
    Heat: _heat,
}
