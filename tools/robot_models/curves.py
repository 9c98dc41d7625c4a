"""Cubic curves through given values.

What is drawn with them is in `surfaces`.
"""

from __future__ import annotations

import numpy as np

from robot_models.triangles import Array


def interpolate(knots: Array, values: Array, at: Array) -> Array:
    """Returns values of a piecewise cubic that does not overshoot its samples.

    Args:
        knots: Where the samples are, increasing, shape (n,), n at least 2.
        values: The samples, shape (n,).
        at: Where to evaluate, any shape.
    """
    if len(knots) == 2:
        return np.interp(at, knots, values)
    widths = np.diff(knots)
    slopes = np.diff(values) / widths
    left, right = slopes[:-1], slopes[1:]
    # Harmonic means, and level at extremes (Fritsch and Butland, 1984).
    same_sign = left * right > 0.0
    safe = np.where(same_sign, left + right, 1.0)
    inner = np.where(same_sign, 2.0 * left * right / safe, 0.0)
    tangents = np.r_[slopes[0], inner, slopes[-1]]
    index = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(widths) - 1)
    width = widths[index]
    return hermite(
        (at - knots[index]) / width,
        values[index],
        values[index + 1],
        width * tangents[index],
        width * tangents[index + 1],
    )


def hermite(
    t: Array, start: Array, end: Array, start_slope: Array, end_slope: Array
) -> Array:
    """Returns the cubic with these ends and slopes at t from 0 to 1."""
    return (
        (1 + 2 * t) * (1 - t) ** 2 * start
        + t * (1 - t) ** 2 * start_slope
        + t**2 * (3 - 2 * t) * end
        - t**2 * (1 - t) * end_slope
    )
