"""``PyKDL.Frame`` and ``Twist``: poses and motions, on Drake's transforms.

The names and conventions are those of the Orocos library; its chains and solvers are
not here.
"""

from __future__ import annotations

import math
from typing import Any

from pydrake.math import RigidTransform

from atlas_drake.ros_scripts.kdl_rotation import Rotation
from atlas_drake.ros_scripts.kdl_vector import Vector, dot


class Twist:
    """A linear and an angular velocity."""

    def __init__(self, vel: Vector | None = None, rot: Vector | None = None) -> None:
        """Makes a twist; missing parts are zero."""
        self.vel, self.rot = Vector(*(vel or ())), Vector(*(rot or ()))

    def __getitem__(self, index: int) -> float:
        return [*self.vel, *self.rot][index]

    def __add__(self, other: Twist) -> Twist:
        return Twist(self.vel + other.vel, self.rot + other.rot)

    def __sub__(self, other: Twist) -> Twist:
        return Twist(self.vel - other.vel, self.rot - other.rot)

    def __mul__(self, factor: float) -> Twist:
        return Twist(self.vel * factor, self.rot * factor)

    def __rmul__(self, other: Any) -> Twist:
        if isinstance(other, Rotation):
            return Twist(other * self.vel, other * self.rot)
        return self * other

    @staticmethod
    def Zero() -> Twist:
        """Returns no motion."""
        return Twist()

    def __repr__(self) -> str:
        return f"[{', '.join(f'{self[i]:12g}' for i in range(6))}]"


class Frame:
    """A pose: rotation ``M`` and position ``p``."""

    def __init__(self, *parts: Any) -> None:
        """Makes a frame of a rotation and a vector, either, a frame, or nothing."""
        self.M, self.p = Rotation(), Vector()
        for part in parts:
            if isinstance(part, Frame):
                self.M, self.p = Rotation(part.M), Vector(*part.p)
            elif isinstance(part, Rotation):
                self.M = Rotation(part)
            elif isinstance(part, Vector):
                self.p = Vector(*part)
            else:
                raise TypeError(
                    "PyKDL.Frame takes a Rotation and a Vector, not "
                    f"{type(part).__name__}"
                )

    @staticmethod
    def Identity() -> Frame:
        """Returns the identity."""
        return Frame()

    @classmethod
    def of(cls, X: RigidTransform) -> Frame:
        """Converts Drake's transform."""
        return cls(Rotation.of(X.rotation()), Vector(*X.translation()))

    def transform(self) -> RigidTransform:
        """Converts to Drake's transform."""
        return RigidTransform(self.M.R, self.p.array)

    def Inverse(self) -> Frame:
        """Returns the inverse."""
        return Frame.of(self.transform().inverse())

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Frame):
            return Frame.of(self.transform() @ other.transform())
        if isinstance(other, Vector):
            return self.M * other + self.p
        if isinstance(other, Twist):
            rot = self.M * other.rot
            return Twist(self.M * other.vel + self.p * rot, rot)
        return NotImplemented

    def __getitem__(self, place: tuple[int, int]) -> float:
        return float(self.transform().GetAsMatrix4()[place])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and self.M == other.M and self.p == other.p

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"[{self.M!r}\n{self.p!r}]"


def diff(one: Any, other: Any, dt: float = 1.0) -> Any:
    """Returns the velocity that leads from one to the other in ``dt`` [s].

    For vectors a Vector, for rotations the angular velocity, for frames a Twist.
    """
    if isinstance(one, Vector):
        return (other - one) / dt
    if isinstance(one, Rotation):
        return one * ((one.Inverse() * other).GetRot() / dt)
    return Twist(diff(one.p, other.p, dt), diff(one.M, other.M, dt))


NAMES: dict[str, Any] = {
    "Frame": Frame,
    "Rotation": Rotation,
    "Twist": Twist,
    "Vector": Vector,
    "diff": diff,
    "dot": dot,
    "deg2rad": math.pi / 180.0,
    "rad2deg": 180.0 / math.pi,
}
"""Contents of ``PyKDL``."""
