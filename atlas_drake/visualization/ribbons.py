"""Lines with a width, because browsers draw Meshcat's lines one pixel thin.

Geometry, and the call that draws it in Meshcat.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, Rgba

Array = NDArray[np.float64]


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
    meshcat: Meshcat,
    path: str,
    vertices: Any,
    faces: Any,
    color: Rgba,
) -> None:
    """Draws triangles without shadow, for signs.

    Args:
        meshcat: Meshcat instance to draw in.
        path: Path of the object.
        vertices: Vertices in the object's frame [m], shape (3, any).
        faces: Triangles as indices of vertices, shape (3, any), int32.
        color: Color of the front and the back.
    """
    points: Any = np.asfortranarray(vertices)
    meshcat.SetTriangleMesh(path, points, faces, color)
    meshcat.SetProperty(f"{path}/<object>", "castShadow", False)
