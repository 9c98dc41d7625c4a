"""Range in which two feet can share the weight for a given center of pressure.

Plane geometry only: no forces, no friction, no phases of a step.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.balance.support_polygon import SupportPolygon

PARALLEL = 1e-12
"""An edge normal along which the extents of the feet differ by less than this does not
limit the share [m²]."""


def load_share_range(
    cop: np.ndarray, flat: SupportPolygon, other: SupportPolygon
) -> tuple[float, float]:
    """Computes the shares of the weight that the other foot can carry for a given CoP.

    With the share s on ``other`` the CoP lies in (1 - s)·``flat`` + s·``other``, a
    Minkowski sum whose edges are parallel to edges of the two polygons. Along each
    outward normal of these edges the condition is linear in s.

    Args:
        cop: Center of pressure in the convex hull of both feet, horizontal in W [m],
            shape (2,).
        flat: Region in which the CoP of the one foot may lie.
        other: Region in which the CoP of the other foot may lie.

    Returns:
        The least and the greatest share [-]; for a point outside the hull both are the
        nearest possible share.
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
