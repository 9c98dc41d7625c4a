"""Convex regions of the ground in which the center of pressure can lie.

Plane geometry only. The hull is found by the monotone chain of Andrew, "Another
efficient algorithm for convex hulls in two dimensions", Information Processing Letters
1979.
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
        self.vertices = convex_hull(np.array([p[:2] for p in points]))
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


def area(corners: np.ndarray) -> float:
    """Computes the area of a polygon [m²]; its corners counterclockwise, (k, 2)."""
    x, y = corners.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def thinned(corners: np.ndarray, most: int) -> np.ndarray:
    """Leaves out the corners of a convex polygon that cut off least, down to ``most``.

    What is left is inside the polygon; shapes (k, 2).
    """
    while len(corners) > most:
        to_last = corners - np.roll(corners, 1, axis=0)
        to_next = np.roll(corners, -1, axis=0) - corners
        cut_off = to_last[:, 0] * to_next[:, 1] - to_last[:, 1] * to_next[:, 0]
        corners = np.delete(corners, int(cut_off.argmin()), axis=0)
    return corners


def convex_hull(points: np.ndarray) -> np.ndarray:
    """Computes the corners of the hull, counter-clockwise, shape (k, 2).

    One point, and points on one line, have a hull without area.
    """
    if len(points) == 1:
        return points
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


PARALLEL = 1e-12
"""An edge normal along which the extents of the feet differ by less than this does not
limit the share [m²]. Numerical: it avoids a division by zero."""


def load_share_range(
    cop: np.ndarray, flat: SupportPolygon, other: SupportPolygon
) -> tuple[float, float]:
    """Computes the least and greatest share of the weight on ``other`` for a given CoP.

    With the share s on ``other`` the CoP lies in (1 - s)·``flat`` + s·``other``, a
    Minkowski sum whose edges are parallel to edges of the two polygons. Along each
    outward normal of these edges the condition is linear in s. For a point outside the
    hull both are the nearest possible share.
    """
    normals = np.concatenate([_edge_normals(flat), _edge_normals(other)])
    near = (normals @ flat.vertices.T).max(axis=1)
    far = (normals @ other.vertices.T).max(axis=1)
    slope, least = far - near, normals @ cop - near
    rising, falling = slope > PARALLEL, slope < -PARALLEL
    low = float((least[rising] / slope[rising]).max(initial=0.0))
    high = float((least[falling] / slope[falling]).min(initial=1.0))
    low, high = min(low, 1.0), max(high, 0.0)
    if low > high:  # The CoP is outside, perhaps by a rounding error only.
        low = high = 0.5 * (low + high)
    return low, high


def _edge_normals(polygon: SupportPolygon) -> np.ndarray:
    """Outward normals of the edges, with the lengths of the edges [m], shape (k, 2)."""
    edges = np.roll(polygon.vertices, -1, axis=0) - polygon.vertices
    return np.column_stack([edges[:, 1], -edges[:, 0]])
