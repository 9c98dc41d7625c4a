"""A page of figures as data: what is drawn, not how.

The panels of a log are made in ``figures``; ``png_page`` and ``html_page`` draw them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

NARROW_SPAN = 0.018
"""Share of the page's time that one letter of a span's name takes [-]."""


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
        names: Of the rows, from the top.
        values: Shape (rows, columns).
        low: Value of the first color.
        high: Value of the last color.
        colors: From low to high, evenly spaced.
        label: Of the color scale, with its unit.
    """

    x: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray
    low: float
    high: float
    colors: tuple[str, ...]
    label: str

    def thinned(self, columns: int) -> tuple[np.ndarray, np.ndarray]:
        """X and values of at most so many columns; the highest values remain."""
        length = -(-len(self.x) // columns)
        starts = np.arange(0, len(self.x), length)
        return self.x[starts], np.maximum.reduceat(self.values, starts, axis=1)


Item: TypeAlias = Line | Band | Outline | Span | Marker | Heat


@dataclass(frozen=True)
class Panel:
    """One figure.

    Attributes:
        title: What it shows.
        y_label: With the unit.
        items: In drawing order.
        x_label: With the unit.
        over_time: Whether x is time, and zooms with that of all such panels.
        equal: Whether both axes have one scale.
        y_range: None is what the items need.
        rows: How many rows of the page's grid it spans.
        row: Its first row in the grid, given by the page.
        column: Likewise.
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
        title: In large letters.
        subtitle: Below it.
        heights: Of the rows of the grid [inch].
        columns: Of the grid.
        panels: In reading order.
        time: First and last instant [s].
    """

    title: str
    subtitle: str
    heights: tuple[float, ...]
    columns: int
    panels: tuple[Panel, ...]
    time: tuple[float, float]

    def has_room(self, span: Span) -> bool:
        """Whether a span's name fits into it."""
        share = (span.end - span.start) / max(self.time[1] - self.time[0], 1e-9)
        return share > NARROW_SPAN * len(span.label)


def thinned(x: np.ndarray, y: np.ndarray, points: int) -> tuple[np.ndarray, np.ndarray]:
    """A curve with fewer points that keeps its extremes.

    Args:
        x: Shape (any,).
        y: Of the same shape.
        points: About how many to keep.

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
