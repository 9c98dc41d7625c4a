"""Solids: triangles with a color, which Meshcat and films draw alike.

Geometry alone; what the solids stand for is in ``shapes``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.palette import Color

Points = NDArray[np.float64]
Triangles = tuple[Points, NDArray[np.int32]]
"""Vertices [m], shape (3, any), and the vertices of each triangle, shape (3, any)."""

TUBE_SIDES, TURNED_SIDES = 6, 20
"""Number of sides of a tube, and of a solid of revolution."""


@dataclass(frozen=True, eq=False)
class Solid:
    """Triangles of one color; solids with equal keys look the same.

    Attributes:
        triangles: The triangles.
        color: Their color.
        opacity: Their opacity, 0 to 1.
        layer: Solids of a layer above 0 are drawn over all below, also over what is in
            front of them.
    """

    triangles: Triangles
    color: Color
    opacity: float = 1.0
    layer: int = 0

    @cached_property
    def key(self) -> tuple[Any, ...]:
        """What the solid looks like, for comparison."""
        vertices, faces = self.triangles
        return vertices.tobytes(), faces.tobytes(), self.color, self.opacity


def polygon(corners: Points) -> Triangles:
    """Makes the triangles of a convex polygon, shape (3, k)."""
    fan = [[0, i, i + 1] for i in range(1, corners.shape[1] - 1)]
    return corners, np.array(fan, dtype=np.int32).T


def grid(at: Points, reach: float, height: float) -> tuple[Points, Points]:
    """Returns the starts and ends of the lines of a square grid [m], shape (3, 2k).

    Places of the lines, shape (k,), are the same along x and y; all lines go from
    ``-reach`` to ``reach`` at one height.
    """
    end, z = np.full(at.size, reach), np.full(at.size, height)
    starts = np.hstack([[at, -end, z], [-end, at, z]])
    return starts, np.hstack([[at, end, z], [end, at, z]])


def ribbons(starts: Points, ends: Points, width: float) -> Triangles:
    """Makes rectangles of a width [m] along line segments in the plane z = 0.

    Starts and ends have the shape (3, k). The rectangles extend beyond both by half the
    width, which closes the corners of chains.
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


def tube(points: Points, radius: float) -> Triangles:
    """Makes a tube of a radius [m] along a curve, shape (k, 3) with k > 1."""
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(points))])
    # Across a vertical part any horizontal direction is valid.
    across[np.linalg.norm(across, axis=1) < 1e-6] = [0.0, 1.0, 0.0]
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(along, across)
    angles = 2.0 * np.pi * np.arange(TUBE_SIDES) / TUBE_SIDES
    sides = [
        points + radius * (np.cos(angle) * across + np.sin(angle) * up)
        for angle in angles
    ]
    return np.stack(sides, axis=1).reshape(-1, 3).T, _between(len(points), TUBE_SIDES)


def turned(profile: Sequence[tuple[float, float]]) -> Triangles:
    """Makes a solid of revolution around z from radii and heights [m], upward."""
    angles = 2.0 * np.pi * np.arange(TURNED_SIDES) / TURNED_SIDES
    radii, heights = np.repeat(profile, TURNED_SIDES, axis=0).T
    around = np.tile([np.cos(angles), np.sin(angles)], len(profile))
    vertices = np.vstack([radii * around, heights])
    return vertices, _between(len(profile), TURNED_SIDES)


def _between(rings: int, sides: int) -> NDArray[np.int32]:
    """Makes the faces between rings of vertices that follow one another."""
    first = np.add.outer(sides * np.arange(rings - 1), np.arange(sides)).ravel()
    beside = first - first % sides + (first + 1) % sides
    faces = np.hstack(
        [[first, beside, first + sides], [beside, beside + sides, first + sides]]
    )
    return faces.astype(np.int32)
