"""Surfaces to build the robot's outside from: lofted hulls, panels on them and tubes.

Where they go and what colour they have is in the `appearance` modules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from atlas_drake.models.generator.parts import Vector

Array: TypeAlias = npt.NDArray[np.float64]
Pair: TypeAlias = tuple[float, float]

_FILLET_RINGS = 3
_DIFFERENCE = 1e-4  # Step of the finite differences that give normals [m or rad].


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


@dataclass(frozen=True)
class Section:
    """Superellipse across a loft.

    Attributes:
        at: Position along the loft [m].
        center: Centre, in the loft's two other axes in alphabetical order [m].
        half: Half sizes along the same axes [m].
        power: 2 is an ellipse; larger values tend to a rectangle.
    """

    at: float
    center: Pair
    half: Pair
    power: float = 2.5


@dataclass(frozen=True)
class Loft:
    """Closed hull through sections along a link axis, with rounded rims.

    Attributes:
        axis: Link axis that it runs along: `"x"`, `"y"` or `"z"`.
        sections: Two or more sections, in increasing order of `at`.
        fillet: Radius of the rims at the first and the last section [m].
        segments: Number of vertices around.
        rings: Number of rings between the rims.
    """

    axis: str
    sections: tuple[Section, ...]
    fillet: Pair = (0.01, 0.01)
    segments: int = 28
    rings: int = 8

    def triangles(self) -> Triangles:
        """Returns the hull as triangles."""
        first, last = self.sections[0].at, self.sections[-1].at
        start, end = self.fillet
        rim = np.linspace(0.0, np.pi / 2, _FILLET_RINGS + 1)
        sink, shrink = 1.0 - np.cos(rim), 1.0 - np.sin(rim)
        middle = np.linspace(first + start, last - end, self.rings + 1)[1:-1]
        at = np.r_[first + start * sink, middle, last - end * sink[::-1]]
        inset = np.r_[start * shrink, 0.0 * middle, end * shrink[::-1]]
        angles = np.linspace(0.0, 2 * np.pi, self.segments, endpoint=False)
        points = self._surface(at[:, None], angles[None, :], inset[:, None])
        return _merge(
            _sheet(points, _outward(points), closed=True),
            _cap(points[0], self._direction(-1.0)),
            _cap(points[-1], self._direction(1.0)),
        )

    def _direction(self, sign: float) -> Array:
        return sign * np.eye(3)["xyz".index(self.axis)]

    def _surface(self, at: Array, angle: Array, inset: Array | float = 0.0) -> Array:
        """Returns points of the hull, shape (..., 3), for broadcastable arguments."""
        knots = np.array([section.at for section in self.sections])

        def value(samples: list[float]) -> Array:
            return _interpolate(knots, np.array(samples), at)

        center_u = value([section.center[0] for section in self.sections])
        center_v = value([section.center[1] for section in self.sections])
        half_u = value([section.half[0] for section in self.sections]) - inset
        half_v = value([section.half[1] for section in self.sections]) - inset
        power = value([section.power for section in self.sections])
        cosine, sine = np.cos(angle), np.sin(angle)
        radius = (np.abs(cosine) ** power + np.abs(sine) ** power) ** (-1.0 / power)
        u = center_u + half_u * radius * cosine
        v = center_v + half_v * radius * sine
        along = np.broadcast_to(at, u.shape)
        order = {"x": (along, u, v), "y": (u, along, v), "z": (u, v, along)}
        return np.stack(order[self.axis], axis=-1)


@dataclass(frozen=True)
class Panel:
    """Plate that follows a loft's outside and stands a little proud of it.

    Attributes:
        loft: Hull that it lies on.
        along: Range along the loft [m].
        around: Range of the angle around it [deg], 0 along the first of the loft's two
            other axes (in alphabetical order) and 90 along the second.
        lift: Height above the hull [m].
    """

    loft: Loft
    along: Pair
    around: Pair
    lift: float = 0.003
    segments: int = 16
    rings: int = 8

    def triangles(self) -> Triangles:
        """Returns the outer side and the rim of the plate as triangles."""
        # Doubled first and last rows: the outer of the two sinks into the hull.
        at = _doubled(np.linspace(*self.along, self.rings + 1))[:, None]
        angle = _doubled(np.radians(np.linspace(*self.around, self.segments + 1)))
        angle = angle[None, :]
        surface = self.loft._surface
        points = surface(at, angle)
        along = surface(at + _DIFFERENCE, angle) - surface(at - _DIFFERENCE, angle)
        around = surface(at, angle + _DIFFERENCE) - surface(at, angle - _DIFFERENCE)
        normals = _unit(np.cross(around, along))
        if self.loft.axis == "y":
            normals = -normals
        lift = np.full(points.shape[:2], self.lift)
        lift[[0, -1], :] = lift[:, [0, -1]] = -0.5 * self.lift
        return _sheet(points + lift[..., None] * normals, normals, closed=False)


@dataclass(frozen=True)
class Tube:
    """Round tube with flat ends along a smooth curve.

    Attributes:
        points: Points of the link frame that the curve passes through [m].
        radius: Radius of the tube [m].
        segments: Number of vertices around.
        steps: Number of rings between two points.
    """

    points: tuple[Vector, ...]
    radius: float
    segments: int = 10
    steps: int = 6

    def triangles(self) -> Triangles:
        """Returns the tube as triangles."""
        knots = np.arange(len(self.points), dtype=float)
        at = np.linspace(0.0, knots[-1], self.steps * (len(knots) - 1) + 1)
        given = np.array(self.points)
        curve = np.stack([_interpolate(knots, given[:, i], at) for i in range(3)], -1)
        tangents = _unit(np.gradient(curve, axis=0))
        # Carrying one normal along keeps the tube from twisting.
        normal = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
        rings = []
        angles = np.linspace(0.0, 2 * np.pi, self.segments, endpoint=False)[:, None]
        for center, tangent in zip(curve, tangents, strict=True):
            normal = _unit(normal - tangent * (tangent @ normal))
            binormal = np.cross(tangent, normal)
            ring = np.cos(angles) * normal + np.sin(angles) * binormal
            rings.append(center + self.radius * ring)
        points = np.array(rings)
        outward = (points - curve[:, None, :]) / self.radius
        return _merge(
            _sheet(points, outward, closed=True),
            _cap(points[0], -tangents[0]),
            _cap(points[-1], tangents[-1]),
        )


Surface: TypeAlias = Loft | Panel | Tube


def merged(surfaces: tuple[Surface, ...]) -> Triangles:
    """Returns several surfaces as one mesh."""
    return _merge(*(surface.triangles() for surface in surfaces))


def _interpolate(knots: Array, values: Array, at: Array) -> Array:
    """Returns a cubic through the values that does not overshoot them."""
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
    t = (at - knots[index]) / width
    return (
        (1 + 2 * t) * (1 - t) ** 2 * values[index]
        + t * (1 - t) ** 2 * width * tangents[index]
        + t**2 * (3 - 2 * t) * values[index + 1]
        - t**2 * (1 - t) * width * tangents[index + 1]
    )


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-12)


def _doubled(values: Array) -> Array:
    return np.r_[values[0], values, values[-1]]


def _outward(points: Array) -> Array:
    """Returns unit normals of a grid of points around a hull, pointing outward."""
    along = np.gradient(points, axis=0)
    around = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    normals = _unit(np.cross(around, along))
    spokes = points - points.mean(axis=1, keepdims=True)
    return normals if np.sum(normals * spokes) > 0.0 else -normals


def _sheet(points: Array, normals: Array, *, closed: bool) -> Triangles:
    """Returns a grid of points, shape (rows, columns, 3), as triangles."""
    rows, columns, _ = points.shape
    numbers = np.arange(rows * columns).reshape(rows, columns)
    if closed:
        numbers = np.c_[numbers, numbers[:, :1]]
    a, b = numbers[:-1, :-1].ravel(), numbers[:-1, 1:].ravel()
    c, d = numbers[1:, 1:].ravel(), numbers[1:, :-1].ravel()
    faces = np.r_[np.c_[a, b, c], np.c_[a, c, d]]
    return _oriented(points.reshape(-1, 3), normals.reshape(-1, 3), faces)


def _cap(ring: Array, normal: Array) -> Triangles:
    """Returns the flat end of a hull."""
    count = len(ring)
    vertices = np.r_[ring, ring.mean(axis=0)[None, :]]
    a = np.arange(count)
    faces = np.c_[a, np.roll(a, -1), np.full(count, count)]
    return _oriented(vertices, np.tile(normal, (count + 1, 1)), faces)


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


def _merge(*meshes: Triangles) -> Triangles:
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Triangles(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate(
            [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
        ),
    )
