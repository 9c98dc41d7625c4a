"""Lines with a width in the plane, and curves in space with a thickness.

Browsers draw Meshcat's own lines one pixel thin.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, Rgba

Array = NDArray[np.float64]

SIDES = 6
"""Number of sides of a tube's cross section."""


def ribbons(
    starts: Array, ends: Array, width: float
) -> tuple[Array, NDArray[np.int32]]:
    """Makes rectangles along line segments in the plane z = 0.

    Args:
        starts: Starts of the segments [m], shape (3, n).
        ends: Ends of the segments [m], shape (3, n).
        width: Width of the lines [m]; the ends extend by half the width, which closes
            the corners of chains.

    Returns:
        Vertices [m], shape (3, 4 n), and triangles, shape (3, 2 n).
    """
    count = starts.shape[1]
    along = (ends - starts)[:2]
    length = np.maximum(np.linalg.norm(along, axis=0), 1e-9)
    along = 0.5 * width * along / length
    across = np.array([-along[1], along[0]])
    vertices = np.zeros((3, 4 * count), order="F")
    vertices[:2, 0::4] = starts[:2] - along + across
    vertices[:2, 1::4] = starts[:2] - along - across
    vertices[:2, 2::4] = ends[:2] + along - across
    vertices[:2, 3::4] = ends[:2] + along + across
    first = 4 * np.arange(count)
    faces = np.hstack([[first, first + 1, first + 2], [first, first + 2, first + 3]])
    return vertices, faces.astype(np.int32)


def draw_flat(
    meshcat: Meshcat, path: str, vertices: Any, faces: Any, color: Rgba
) -> None:
    """Draws triangles without shadow, for signs; shapes as ``ribbons`` returns them."""
    points: Any = np.asfortranarray(vertices)
    meshcat.SetTriangleMesh(path, points, faces, color)
    meshcat.SetProperty(f"{path}/<object>", "castShadow", False)


def thinned(points: Array, bend: float) -> Array:
    """Removes points of a curve that do not change its look.

    After Ramer (1972) and Douglas and Peucker (1973).

    Args:
        points: Points along the curve [m], shape (k, 3), k > 1.
        bend: Greatest distance of a removed point from the result [m].

    Returns:
        Some of the points, first and last among them, shape (any, 3).
    """
    kept = {0, len(points) - 1}
    pieces = [(0, len(points) - 1)]
    while pieces:
        first, last = pieces.pop()
        between = points[first + 1 : last] - points[first]
        if not len(between):
            continue
        chord = points[last] - points[first]
        length = float(chord @ chord)
        share = between @ chord / length if length > 0.0 else np.zeros(len(between))
        nearest = np.outer(np.clip(share, 0.0, 1.0), chord)
        away = np.linalg.norm(between - nearest, axis=1)
        farthest = int(np.argmax(away))
        if away[farthest] > bend:
            middle = first + 1 + farthest
            kept.add(middle)
            pieces += [(first, middle), (middle, last)]
    return points[sorted(kept)]


def tube(points: Array, radius: float) -> tuple[Array, NDArray[np.int32]]:
    """Makes a tube along a curve without long vertical parts.

    Args:
        points: Points along the curve [m], shape (k, 3), k > 1.
        radius: Radius of the tube [m].

    Returns:
        Vertices [m], shape (3, SIDES k), and triangles, shape (3, 2 SIDES (k - 1)).
    """
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    # Across a vertical part any horizontal direction is valid.
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(points))])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(length > 1e-6, across / np.maximum(length, 1e-9), [0.0, 1.0, 0.0])
    up = np.cross(along, across)
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    rings = [
        points + radius * (np.cos(angle) * across + np.sin(angle) * up)
        for angle in angles
    ]
    vertices = np.stack(rings, axis=1).reshape(-1, 3).T
    first = np.add.outer(SIDES * np.arange(len(points) - 1), np.arange(SIDES)).ravel()
    beside = first - first % SIDES + (first + 1) % SIDES
    faces = np.hstack(
        [[first, beside, first + SIDES], [beside, beside + SIDES, first + SIDES]]
    )
    return vertices, faces.astype(np.int32)
