"""``PyKDL``, ``tf_conversions.posemath`` and ``tf.transformations`` on Drake's math.

Holds what programs for DRCSim used to place footsteps; names and conventions are those
of the originals. Quaternions are x, y, z, w. Euler angles are roll, pitch, yaw about
fixed axes ("sxyz"), the default convention of the original.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.ros_scripts.message_types import geometry_msgs
from atlas_drake.ros_scripts.unknown import unknown

AXES = "sxyz"
"""The convention of Euler angles."""


class Vector:
    """``PyKDL.Vector``."""

    def __init__(self, *xyz: float) -> None:
        """Makes a vector of x, y, z, or the zero vector."""
        self.array = np.array(xyz or (0.0, 0.0, 0.0), dtype=float)
        if self.array.shape != (3,):
            raise TypeError(f"PyKDL.Vector takes 3 numbers, is given {len(xyz)}")

    def x(self) -> float:
        """Returns the first number."""
        return self[0]

    def y(self) -> float:
        """Returns the second number."""
        return self[1]

    def z(self) -> float:
        """Returns the third number."""
        return self[2]

    def __getitem__(self, index: int) -> float:
        return float(self.array[index])

    def __setitem__(self, index: int, value: float) -> None:
        self.array[index] = value

    def __iter__(self) -> Iterator[float]:
        return iter(self.array.tolist())

    def __add__(self, other: Vector) -> Vector:
        return Vector(*(self.array + other.array))

    def __sub__(self, other: Vector) -> Vector:
        return Vector(*(self.array - other.array))

    def __mul__(self, factor: float) -> Vector:
        return Vector(*(self.array * float(factor)))

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> Vector:
        return self * (1.0 / divisor)

    def __neg__(self) -> Vector:
        return self * -1.0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vector) and np.array_equal(self.array, other.array)

    __hash__ = None  # type: ignore[assignment]

    def Norm(self) -> float:
        """Returns the length."""
        return float(np.linalg.norm(self.array))

    def __repr__(self) -> str:
        return "[" + ", ".join(f"{number:12g}" for number in self) + "]"


class Rotation:
    """``PyKDL.Rotation``."""

    def __init__(self, R: Rotation | RotationMatrix | None = None) -> None:
        """Copies a rotation, or makes the identity."""
        given = R.R if isinstance(R, Rotation) else R
        self.R: RotationMatrix = given or RotationMatrix()

    @staticmethod
    def Quaternion(x: float, y: float, z: float, w: float) -> Rotation:
        """Returns the rotation of a quaternion; no rotation for one of zeros."""
        wxyz = np.array([w, x, y, z], dtype=float)
        norm = np.linalg.norm(wxyz)
        if not norm > 0.0:
            return Rotation()
        return Rotation(RotationMatrix(Quaternion(wxyz / norm)))

    @staticmethod
    def RPY(roll: float, pitch: float, yaw: float) -> Rotation:
        """Returns the rotation about fixed x, then y, then z."""
        return Rotation(RotationMatrix(RollPitchYaw(roll, pitch, yaw)))

    @staticmethod
    def RotZ(angle: float) -> Rotation:
        """Returns a rotation about z."""
        return Rotation.RPY(0.0, 0.0, angle)

    def GetQuaternion(self) -> tuple[float, float, float, float]:
        """Returns x, y, z, w."""
        w, x, y, z = (float(number) for number in self.R.ToQuaternion().wxyz())
        return x, y, z, w

    def GetRPY(self) -> tuple[float, float, float]:
        """Returns roll, pitch and yaw."""
        roll, pitch, yaw = RollPitchYaw(self.R).vector()
        return float(roll), float(pitch), float(yaw)

    def Inverse(self) -> Rotation:
        """Returns the inverse."""
        return Rotation(self.R.inverse())

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Rotation):
            return Rotation(self.R @ other.R)
        if isinstance(other, Vector):
            return Vector(*(self.R.matrix() @ other.array))
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rotation) and np.array_equal(
            self.R.matrix(), other.R.matrix()
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        rows = (", ".join(f"{x:12g}" for x in row) for row in self.R.matrix())
        return "[" + ";\n ".join(rows) + "]"


class Frame:
    """``PyKDL.Frame``: a pose of rotation ``M`` and position ``p``."""

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

    def Inverse(self) -> Frame:
        """Returns the inverse."""
        back = self.M.Inverse()
        return Frame(back, -(back * self.p))

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Frame):
            return Frame(self.M * other.M, self * other.p)
        if isinstance(other, Vector):
            return self.M * other + self.p
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and self.M == other.M and self.p == other.p

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"[{self.M!r}\n{self.p!r}]"


def from_msg(pose: Any) -> Frame:
    """Return the Frame of a Pose."""
    p, q = pose.position, pose.orientation
    return Frame(Rotation.Quaternion(q.x, q.y, q.z, q.w), Vector(p.x, p.y, p.z))


def to_msg(frame: Frame) -> Any:
    """Return the Pose of a Frame."""
    pose: Any = geometry_msgs["Pose"]()
    pose.position = geometry_msgs["Point"](*frame.p)
    pose.orientation = geometry_msgs["Quaternion"](*frame.M.GetQuaternion())
    return pose


def quaternion_from_euler(
    roll: float, pitch: float, yaw: float, axes: str = AXES
) -> np.ndarray:
    """Return x, y, z, w of a rotation about fixed x, then y, then z."""
    _check(axes)
    return np.array(Rotation.RPY(roll, pitch, yaw).GetQuaternion())


def euler_from_quaternion(
    quaternion: Sequence[float], axes: str = AXES
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw."""
    _check(axes)
    return Rotation.Quaternion(*quaternion).GetRPY()


def quaternion_multiply(one: Sequence[float], other: Sequence[float]) -> np.ndarray:
    """Return the product: first ``other``, then ``one``."""
    product = Rotation.Quaternion(*one) * Rotation.Quaternion(*other)
    return np.array(product.GetQuaternion())


def _check(axes: str) -> None:
    if axes != AXES:
        raise unknown(f"the convention {axes!r} of Euler angles", axes, [AXES])


KDL: dict[str, Any] = {"Frame": Frame, "Rotation": Rotation, "Vector": Vector}
"""Contents of ``PyKDL``."""
POSEMATH: dict[str, Any] = {"fromMsg": from_msg, "toMsg": to_msg}
"""Contents of ``tf_conversions.posemath`` and of ``tf_conversions``."""
TRANSFORMATIONS: dict[str, Any] = {
    function.__name__: function
    for function in (quaternion_from_euler, euler_from_quaternion, quaternion_multiply)
}
"""Contents of ``tf.transformations``."""
