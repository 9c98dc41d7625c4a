"""A page of figures as data, independent of the drawing library.

The panels of a log are made in ``figures``; ``png_page`` and ``html_page`` draw them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

JOINT_COLORS = ("#1f77b4", "#d95f02", "#2a9d3a", "#c2185b", "#7e57c2", "#8d6e63")
"""Colors of curves that stand for joints or axes."""
NARROW_SPAN = 0.018
"""Width of one letter of a span's name, as a share of the page's time [-]."""


@dataclass(frozen=True)
class Line:
    """A curve; gaps where a value is NaN. Without a label it is not in the legend."""

    x: np.ndarray
    y: np.ndarray
    color: str
    label: str = ""
    dashed: bool = False
    width: float = 1.1


@dataclass(frozen=True)
class Band:
    """The area between two curves over the same x; gaps where they are NaN."""

    x: np.ndarray
    low: np.ndarray
    high: np.ndarray
    color: str
    label: str = ""


@dataclass(frozen=True)
class Outline:
    """A closed polygon with corners of shape (any, 2), filled or not."""

    corners: np.ndarray
    color: str
    label: str = ""
    opacity: float = 0.0
    dashed: bool = False

    @property
    def closed(self) -> np.ndarray:
        """X and y of the corners, the first one again at the end, shape (2, any)."""
        return np.vstack([self.corners, self.corners[:1]]).T


@dataclass(frozen=True)
class Span:
    """A piece of a timeline with its name in it."""

    start: float
    end: float
    color: str
    label: str


@dataclass(frozen=True)
class Marker:
    """A vertical line at an instant."""

    x: float
    color: str
    label: str


@dataclass(frozen=True)
class Heat:
    """A map of numbers: one row per name, one column per x.

    Attributes:
        x: Shape (columns,), increasing.
        names: Names of the rows, from the top.
        values: Shape (rows, columns).
        low: Value of the first color.
        high: Value of the last color.
        colors: From low to high, evenly spaced.
        label: Label of the color scale, with its unit.
    """

    x: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray
    low: float
    high: float
    colors: tuple[str, ...]
    label: str

    def thinned(self, columns: int) -> tuple[np.ndarray, np.ndarray]:
        """Reduces the map to at most ``columns`` columns; the highest values remain."""
        length = -(-len(self.x) // columns)
        starts = np.arange(0, len(self.x), length)
        return self.x[starts], np.maximum.reduceat(self.values, starts, axis=1)


Item: TypeAlias = Line | Band | Outline | Span | Marker | Heat


@dataclass(frozen=True)
class Panel:
    """One figure.

    Attributes:
        title: Title above the panel.
        y_label: Label of the y axis, with its unit.
        items: Items in drawing order.
        x_label: Label of the x axis, with its unit.
        over_time: True if x is time; all such panels zoom together.
        equal: True if both axes have one scale.
        y_range: Range of the y axis; None is the range of the items.
        rows: Number of rows of the page's grid that the panel spans.
        row: First row in the grid, given by the page.
        column: Column in the grid, given by the page.
    """

    title: str
    y_label: str
    items: tuple[Item, ...]
    x_label: str = "time [s]"
    over_time: bool = True
    equal: bool = False
    y_range: tuple[float, float] | None = None
    rows: int = 1
    row: int = 0
    column: int = 0


@dataclass(frozen=True)
class Page:
    """All figures of a log.

    Attributes:
        title: Title in large letters.
        subtitle: Line below the title.
        heights: Heights of the rows of the grid [inch].
        columns: Number of columns of the grid.
        panels: Panels in reading order.
        time: First and last instant [s].
    """

    title: str
    subtitle: str
    heights: tuple[float, ...]
    columns: int
    panels: tuple[Panel, ...]
    time: tuple[float, float]

    def has_room(self, span: Span) -> bool:
        """Returns True if a span's name fits into the span."""
        share = (span.end - span.start) / max(self.time[1] - self.time[0], 1e-9)
        return share > NARROW_SPAN * len(span.label)


def thinned(x: np.ndarray, y: np.ndarray, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Thins a curve to about so many points, and keeps its extremes.

    Returns:
        x and y of the lowest and the highest point of each piece of the curve.
    """
    pieces = max(points // 2, 1)
    length = -(-len(y) // pieces)
    if length <= 2:
        return x, y
    full = len(y) // length * length
    blocks = y[:full].reshape(-1, length)
    gaps = np.isnan(blocks)
    starts = np.arange(0, full, length)
    lowest = starts + np.where(gaps, np.inf, blocks).argmin(axis=1)
    highest = starts + np.where(gaps, -np.inf, blocks).argmax(axis=1)
    # One point of a gap keeps the gap.
    holes = (starts + gaps.argmax(axis=1))[gaps.any(axis=1)]
    kept = np.unique(
        np.concatenate([[0], lowest, highest, holes, np.arange(full, len(y))])
    ).astype(int)
    return x[kept], y[kept]
