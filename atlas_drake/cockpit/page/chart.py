"""Curves over time as SVG: one chart for each unit."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence

from atlas_drake.cockpit.state import BESIDE
from atlas_drake.palette import Color, hex_color

Sample = tuple[float, Mapping[str, float]]
WIDTH, HEIGHT = 300.0, 96.0
"""Of a chart [pixel]."""
LEFT, RIGHT, TOP, BOTTOM = 40.0, 4.0, 6.0, 14.0
"""Margins of a chart [pixel]."""
COLORS: tuple[Color, ...] = (
    (0.20, 0.52, 0.90),
    (0.93, 0.52, 0.10),
    (0.20, 0.65, 0.35),
    (0.80, 0.25, 0.55),
    (0.55, 0.40, 0.85),
    (0.55, 0.55, 0.20),
)
"""Of the curves, in order."""


def color_of(place: int) -> str:
    """Returns the color of a curve by its place in the list."""
    return hex_color(COLORS[place % len(COLORS)])


def charts(
    samples: Sequence[Sample],
    names: Sequence[str],
    units: Mapping[str, str],
    begin: float,
    end: float,
) -> str:
    """Draws curves between two times [s], those of a unit in one chart."""
    shown = [sample for sample in samples if begin <= sample[0] <= end]
    by_unit: dict[str, list[int]] = {}
    for place, name in enumerate(names):
        by_unit.setdefault(units.get(name, ""), []).append(place)
    return "".join(
        _chart(shown, {names[place]: color_of(place) for place in places}, unit, span)
        for (unit, places), span in zip(
            by_unit.items(), [(begin, end)] * len(by_unit), strict=True
        )
    )


def _chart(
    samples: Sequence[Sample],
    colors: Mapping[str, str],
    unit: str,
    span: tuple[float, float],
) -> str:
    curves = {}
    for name in colors:
        for full, dash in ((name, ""), (name + BESIDE, ' stroke-dasharray="4 3"')):
            points = [(t, v[full]) for t, v in samples if full in v]
            if points:
                curves[full] = points, colors[name], dash
    numbers = [v for points, _, _ in curves.values() for _, v in points]
    low, high = _bounds([v for v in numbers if math.isfinite(v)])
    begin, end = span

    def at(time: float, value: float) -> str:
        x = LEFT + (WIDTH - LEFT - RIGHT) * (time - begin) / (end - begin)
        y = TOP + (HEIGHT - TOP - BOTTOM) * (high - value) / (high - low)
        return f"{x:.1f},{y:.1f}"

    lines = [
        f'<polyline points="{" ".join(at(*point) for point in piece)}" '
        f'stroke="{color}"{dash}/>'
        for points, color, dash in curves.values()
        for piece in _pieces(points)
    ]
    bottom = HEIGHT - BOTTOM
    names = ", ".join(html.escape(name) for name in colors)
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" '
        f'aria-label="{names} [{html.escape(unit) or "-"}]">'
        f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - RIGHT}" '
        f'height="{bottom - TOP}"/>'
        f'<text x="{LEFT - 3}" y="{TOP + 8}" class="end">{high:.3g}</text>'
        f'<text x="{LEFT - 3}" y="{0.5 * (TOP + bottom) + 4}" class="end">'
        f"{html.escape(unit)}</text>"
        f'<text x="{LEFT - 3}" y="{bottom}" class="end">{low:.3g}</text>'
        f'<text x="{LEFT}" y="{HEIGHT - 3}">{begin:.1f} s</text>'
        f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 3}" class="end">{end:.1f} s</text>'
        f"{''.join(lines)}</svg>"
    )


def _bounds(numbers: Sequence[float]) -> tuple[float, float]:
    """Returns ends of the axis that hold all numbers, and are apart."""
    if not numbers:
        return 0.0, 1.0
    low, high = min(numbers), max(numbers)
    margin = 0.05 * (high - low) or max(0.05 * abs(high), 1e-3)
    return low - margin, high + margin


def _pieces(points: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """Parts a curve where it has no value, and thins it to a point for each pixel."""
    every = max(len(points) // int(WIDTH), 1)
    pieces: list[list[tuple[float, float]]] = [[]]
    for time, value in points[::every]:
        if math.isfinite(value):
            pieces[-1].append((time, value))
        elif pieces[-1]:
            pieces.append([])
    return [piece for piece in pieces if piece]
