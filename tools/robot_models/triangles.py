"""Triangle meshes, and how grids and rings of points become such.

The surfaces that the points lie on are in `surfaces`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Triangles:
    """Triangle mesh.

    Attributes:
        vertices: Positions [m], shape (n, 3).
        normals: Outward unit normals, shape (n, 3).
        faces: Vertex numbers, counter-clockwise seen from outside, shape (m, 3).
    """

    vertices: Array
    normals: Array
    faces: npt.NDArray[np.int64]

    def mirrored(self) -> Triangles:
        """Returns the mirror image in the plane y = 0."""
        flip = np.array([1.0, -1.0, 1.0])
        return Triangles(self.vertices * flip, self.normals * flip, self.faces[:, ::-1])


def sheet(points: Array, normals: Array, *, closed: bool) -> Triangles:
    """Returns a grid of points as triangles.

    Args:
        points: Points [m], shape (rows, columns, 3).
        normals: Outward unit normals, shape (rows, columns, 3).
        closed: Whether the last column is joined to the first one.
    """
    rows, columns, _ = points.shape
    numbers = np.arange(rows * columns).reshape(rows, columns)
    if closed:
        numbers = np.c_[numbers, numbers[:, :1]]
    a, b = numbers[:-1, :-1].ravel(), numbers[:-1, 1:].ravel()
    c, d = numbers[1:, 1:].ravel(), numbers[1:, :-1].ravel()
    faces = np.r_[np.c_[a, b, c], np.c_[a, c, d]]
    return _oriented(points.reshape(-1, 3), normals.reshape(-1, 3), faces)


def cap(ring: Array, normal: Array) -> Triangles:
    """Returns a flat disc that fills a ring.

    Args:
        ring: Points of the ring [m], shape (n, 3).
        normal: Outward unit normal, shape (3,).
    """
    count = len(ring)
    vertices = np.r_[ring, ring.mean(axis=0)[None, :]]
    a = np.arange(count)
    faces = np.c_[a, np.roll(a, -1), np.full(count, count)]
    return _oriented(vertices, np.tile(normal, (count + 1, 1)), faces)


def merge(*meshes: Triangles) -> Triangles:
    """Returns several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Triangles(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate(
            [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
        ),
    )


def outward(points: Array) -> Array:
    """Returns unit normals of a grid of points around a hull, pointing outward."""
    along = np.gradient(points, axis=0)
    around = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    normals = unit(np.cross(around, along))
    spokes = points - points.mean(axis=1, keepdims=True)
    return normals if np.sum(normals * spokes) > 0.0 else -normals


def unit(vectors: Array) -> Array:
    """Returns the vectors, shape (..., n), scaled to length one."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-12)


def _oriented(
    vertices: Array, normals: Array, faces: npt.NDArray[np.int64]
) -> Triangles:
    """Turns all faces over if they disagree with the normals."""
    corners = vertices[faces]
    actual = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wanted = normals[faces].sum(axis=1)
    if np.sum(actual * wanted) < 0.0:
        faces = faces[:, ::-1]
    return Triangles(vertices, normals, faces)
