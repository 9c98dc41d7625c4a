"""How two feet can share the weight, given where the center of pressure shall be.

Plane geometry only: no forces, no friction, no phases of a step.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.balance.support_polygon import SupportPolygon

PARALLEL = 1e-12
"""Feet whose extents along a direction differ by less limit no share there [m²]."""


def load_share_range(
    cop: np.ndarray, flat: SupportPolygon, other: SupportPolygon
) -> tuple[float, float]:
    """Shares of the weight that the other foot can carry with the CoP in one place.

    With the share s on ``other`` the CoP lies in (1 - s)·``flat`` + s·``other``, a
    Minkowski sum whose edges are parallel to edges of the two polygons. Along each
    outward normal of these edges the condition is linear in s.

    Args:
        cop: In the convex hull of both feet, horizontal in W [m], shape (2,).
        flat: Where the CoP of the one foot may lie.
        other: Where the CoP of the other foot may lie.

    Returns:
        The least and the largest share [-]; both the nearest possible for a point
        outside the hull.
    """
    normals = np.concatenate([_edge_normals(flat), _edge_normals(other)])
    near = (normals @ flat.vertices.T).max(axis=1)
    far = (normals @ other.vertices.T).max(axis=1)
    slope, least = far - near, normals @ cop - near
    rising, falling = slope > PARALLEL, slope < -PARALLEL
    low = float((least[rising] / slope[rising]).max(initial=0.0))
    high = float((least[falling] / slope[falling]).min(initial=1.0))
    low, high = min(low, 1.0), max(high, 0.0)
    if low > high:  # Outside, if only by rounding.
        low = high = 0.5 * (low + high)
    return low, high


def _edge_normals(polygon: SupportPolygon) -> np.ndarray:
    """Outward normals of the edges, as long as these [m], shape (k, 2)."""
    edges = np.roll(polygon.vertices, -1, axis=0) - polygon.vertices
    return np.column_stack([edges[:, 1], -edges[:, 0]])
