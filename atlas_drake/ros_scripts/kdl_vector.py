"""``PyKDL.Vector``: three numbers.

The names and conventions are those of the Orocos library.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np


class Vector:
    """Three numbers."""

    def __init__(self, *xyz: Any) -> None:
        """Makes a vector of x, y, z, of another vector, or of nothing: zero."""
        source = xyz[0] if len(xyz) == 1 else (xyz or (0.0, 0.0, 0.0))
        self.array = np.array([float(number) for number in source])
        if self.array.shape != (3,):
            raise TypeError(f"PyKDL.Vector takes 3 numbers, is given {len(self.array)}")

    def x(self, value: float | None = None) -> Any:
        """Returns the first number, or sets it."""
        return self._component(0, value)

    def y(self, value: float | None = None) -> Any:
        """Returns the second number, or sets it."""
        return self._component(1, value)

    def z(self, value: float | None = None) -> Any:
        """Returns the third number, or sets it."""
        return self._component(2, value)

    def _component(self, index: int, value: float | None) -> Any:
        if value is None:
            return float(self.array[index])
        self.array[index] = value
        return None

    def __getitem__(self, index: int) -> float:
        return float(self.array[index])

    def __setitem__(self, index: int, value: float) -> None:
        self.array[index] = value

    def __iter__(self) -> Iterator[float]:
        return iter(self.array.tolist())

    def __len__(self) -> int:
        return 3

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.array + other.array)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.array - other.array)

    def __neg__(self) -> Vector:
        return Vector(-self.array)

    def __mul__(self, other: Any) -> Vector:
        """Scale; the product of two vectors is their cross product, as in KDL."""
        if isinstance(other, Vector):
            return Vector(np.cross(self.array, other.array))
        return Vector(self.array * float(other))

    def __rmul__(self, factor: float) -> Vector:
        return Vector(self.array * float(factor))

    def __truediv__(self, divisor: float) -> Vector:
        return Vector(self.array / float(divisor))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vector) and bool((self.array == other.array).all())

    __hash__ = None  # type: ignore[assignment]

    def Norm(self) -> float:
        """Returns the length."""
        return float(np.linalg.norm(self.array))

    def Normalize(self) -> float:
        """Scales the vector to length 1; returns the previous length."""
        norm = self.Norm()
        self.array = self.array / norm if norm > 0.0 else np.array([1.0, 0.0, 0.0])
        return norm

    @staticmethod
    def Zero() -> Vector:
        """Returns the zero vector."""
        return Vector()

    def __repr__(self) -> str:
        return "[" + ", ".join(f"{number:12g}" for number in self) + "]"


def dot(one: Vector, other: Vector) -> float:
    """Returns the scalar product."""
    return float(one.array @ other.array)
