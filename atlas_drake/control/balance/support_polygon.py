"""Convex regions of the ground in which the center of pressure can lie.

Plane geometry only.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from atlas_drake.frozen import Frozen


class SupportPolygon(Frozen):
    """The convex hull of points on the ground.

    Attributes:
        vertices: Corners, counter-clockwise, in W [m], shape (k, 2).
    """

    def __init__(self, points: Iterable[np.ndarray]):
        """Takes the convex hull of at least three points not on one line."""
        self.vertices = _convex_hull(np.array([p[:2] for p in points]))
        ahead = np.roll(self.vertices, -1, axis=0)
        edges = ahead - self.vertices
        lengths = np.sqrt((edges**2).sum(axis=1))
        self._directions = edges / lengths[:, None]
        self._lengths = lengths
        self._normals = np.column_stack(
            [self._directions[:, 1], -self._directions[:, 0]]
        )
        self._offsets = (self._normals * self.vertices).sum(axis=1)

    def distance_outside(self, point: np.ndarray) -> float:
        """Signed distance of ``point`` beyond the nearest edge line [m]; < 0 inside."""
        return float((self._normals @ point - self._offsets).max())

    def clamp(self, point: np.ndarray) -> np.ndarray:
        """Returns the point of the polygon nearest to ``point`` [m], shape (2,)."""
        outside = self._normals @ point - self._offsets
        if outside.max() <= 0.0:
            return point
        along = ((point - self.vertices) * self._directions).sum(axis=1)
        along = np.minimum(np.maximum(along, 0.0), self._lengths)
        nearest = self.vertices + self._directions * along[:, None]
        gaps = ((nearest - point) ** 2).sum(axis=1)
        return nearest[int(gaps.argmin())]


def _convex_hull(points: np.ndarray) -> np.ndarray:
    """Andrew's monotone chain, counter-clockwise."""
    ordered = sorted(map(tuple, points))
    halves = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 1e-12:
                    break
                chain.pop()
            chain.append((x, y))
        halves.append(chain[:-1])
    return np.array(halves[0] + halves[1])
