"""Surfaces to build the robot's outside from: lofted hulls, panels on them and tubes.

Where they go and what color they have is in the `appearance` modules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from robot_models.curves import hermite, interpolate
from robot_models.parts import Vector
from robot_models.triangles import (
    Array,
    Triangles,
    cap,
    merge,
    outward,
    sheet,
    unit,
)

Pair: TypeAlias = tuple[float, float]

_FILLET_RINGS = 2
_DIFFERENCE = 1e-4  # Step of the finite differences that give normals [m or rad].


@dataclass(frozen=True)
class Section:
    """Superellipse across a loft.

    Attributes:
        at: Position along the loft [m].
        center: Center, in the loft's two other axes in alphabetical order [m].
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
        fillet: Radius of the rims at the first and the last section, positive [m].
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
        return merge(
            sheet(points, outward(points), closed=True),
            cap(points[0], self._direction(-1.0)),
            cap(points[-1], self._direction(1.0)),
        )

    def _direction(self, sign: float) -> Array:
        return sign * np.eye(3)["xyz".index(self.axis)]

    def _surface(self, at: Array, angle: Array, inset: Array | float = 0.0) -> Array:
        """Returns points of the hull, shape (..., 3), for broadcastable arguments."""
        knots = np.array([section.at for section in self.sections])

        def value(samples: list[float]) -> Array:
            return interpolate(knots, np.array(samples), at)

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
        segments: Number of faces around.
        rings: Number of faces along.
    """

    loft: Loft
    along: Pair
    around: Pair
    lift: float = 0.003
    segments: int = 16
    rings: int = 4

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
        normals = unit(np.cross(around, along))
        if self.loft.axis == "y":
            normals = -normals
        lift = np.full(points.shape[:2], self.lift)
        lift[[0, -1], :] = lift[:, [0, -1]] = -0.5 * self.lift
        return sheet(points + lift[..., None] * normals, normals, closed=False)


@dataclass(frozen=True)
class Tube:
    """Round tube along a smooth curve, closed if the curve ends where it starts.

    Attributes:
        points: Points of the link frame that the curve passes through [m].
        radius: Radius of the tube [m].
        rim: Radius of the rims at its ends, positive [m]; a closed tube has none.
        segments: Number of vertices around.
        steps: Number of rings between two points.
    """

    points: tuple[Vector, ...]
    radius: float
    rim: float = 0.002
    segments: int = 10
    steps: int = 5

    def triangles(self) -> Triangles:
        """Returns the tube as triangles."""
        curve, tangents = self._curve()
        closed = self.points[0] == self.points[-1]
        inset = np.zeros(len(curve))
        if not closed:
            quarter = np.linspace(0.0, np.pi / 2, _FILLET_RINGS + 1)
            sink = (self.rim * (1.0 - np.cos(quarter)))[:, None]
            shrink = self.rim * (1.0 - np.sin(quarter))
            head, tail = curve[0] + sink * tangents[0], curve[-1] - sink * tangents[-1]
            curve = np.r_[head, curve[1:-1], tail[::-1]]
            repeats = np.ones(len(tangents), dtype=int)
            repeats[[0, -1]] = len(quarter)
            tangents = np.repeat(tangents, repeats, axis=0)
            inset = np.r_[shrink, inset[1:-1], shrink[::-1]]
        # Carrying one normal along keeps the tube from twisting.
        normal = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
        angles = np.linspace(0.0, 2 * np.pi, self.segments, endpoint=False)[:, None]
        rings = []
        for center, tangent, shrunk in zip(curve, tangents, inset, strict=True):
            normal = unit(normal - tangent * (tangent @ normal))
            binormal = np.cross(tangent, normal)
            ring = np.cos(angles) * normal + np.sin(angles) * binormal
            rings.append(center + (self.radius - shrunk) * ring)
        points = np.array(rings)
        side = sheet(points, outward(points), closed=True)
        if closed:
            return side
        ends = (cap(points[0], -tangents[0]), cap(points[-1], tangents[-1]))
        return merge(side, *ends)

    def _curve(self) -> tuple[Array, Array]:
        """Returns points on the curve and its unit tangents, shape (n, 3) each."""
        given = np.array(self.points)
        slopes = np.gradient(given, axis=0)
        if self.points[0] == self.points[-1]:
            slopes[[0, -1]] = (given[1] - given[-2]) / 2
        at = np.linspace(0.0, len(given) - 1, self.steps * (len(given) - 1) + 1)
        index = np.minimum(at.astype(int), len(given) - 2)
        t = (at - index)[:, None]
        curve = hermite(
            t, given[index], given[index + 1], slopes[index], slopes[index + 1]
        )
        tangents = np.gradient(curve, axis=0)
        tangents[[0, -1]] = slopes[[0, -1]]
        return curve, unit(tangents)


Surface: TypeAlias = Loft | Panel | Tube


def _doubled(values: Array) -> Array:
    return np.r_[values[0], values, values[-1]]
