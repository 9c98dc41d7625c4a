"""``PyKDL``, ``tf_conversions.posemath`` and ``tf.transformations`` on Drake's math.

Holds what programs for DRCSim used to place footsteps; names and conventions are those
of the originals. Quaternions are x, y, z, w; roll, pitch and yaw are about fixed axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.clients.ros_scripts.ros_types import geometry_msgs


class Vector(np.ndarray[Any, Any]):
    """``PyKDL.Vector``: adds, scales and is indexed as an array of three numbers."""

    def __new__(cls, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Vector:
        """Makes a vector, without arguments the zero vector."""
        return np.array([x, y, z], dtype=float).view(cls)

    def x(self) -> float:
        """Returns the first number."""
        return float(self[0])

    def y(self) -> float:
        """Returns the second number."""
        return float(self[1])

    def z(self) -> float:
        """Returns the third number."""
        return float(self[2])


class Rotation:
    """``PyKDL.Rotation``."""

    def __init__(self, R: RotationMatrix | None = None) -> None:
        """Holds a rotation matrix, or the identity."""
        self.R = R or RotationMatrix()

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

    def GetQuaternion(self) -> tuple[float, ...]:
        """Returns x, y, z, w."""
        w, *xyz = self.R.ToQuaternion().wxyz().tolist()
        return (*xyz, w)

    def GetRPY(self) -> tuple[float, ...]:
        """Returns roll, pitch and yaw."""
        return tuple(RollPitchYaw(self.R).vector().tolist())

    def Inverse(self) -> Rotation:
        """Returns the inverse."""
        return Rotation(self.R.inverse())

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Vector):
            return Vector(*(self.R.matrix() @ other))
        return Rotation(self.R @ other.R)


class Frame:
    """``PyKDL.Frame``: a pose of rotation ``M`` and position ``p``."""

    def __init__(self, *parts: Rotation | Vector) -> None:
        """Makes a frame of a rotation and a vector, of either, or of nothing."""
        self.M, self.p = Rotation(), Vector()
        for part in parts:
            if isinstance(part, Rotation):
                self.M = part
            else:
                self.p = Vector(*part)

    def Inverse(self) -> Frame:
        """Returns the inverse."""
        back = self.M.Inverse()
        return Frame(back, -(back * self.p))

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Vector):
            return self.M * other + self.p
        return Frame(self.M * other.M, self * other.p)


def from_msg(pose: Any) -> Frame:
    """Return the Frame of a Pose."""
    p, q = pose.position, pose.orientation
    return Frame(Rotation.Quaternion(q.x, q.y, q.z, q.w), Vector(p.x, p.y, p.z))


def to_msg(frame: Frame) -> Any:
    """Return the Pose of a Frame."""
    return geometry_msgs["Pose"](
        geometry_msgs["Point"](*frame.p.tolist()),
        geometry_msgs["Quaternion"](*frame.M.GetQuaternion()),
    )


def quaternion_from_euler(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Return x, y, z, w of a rotation about fixed x, then y, then z."""
    return np.array(Rotation.RPY(roll, pitch, yaw).GetQuaternion())


def euler_from_quaternion(quaternion: Sequence[float]) -> tuple[float, ...]:
    """Return roll, pitch, yaw."""
    return Rotation.Quaternion(*quaternion).GetRPY()


KDL: dict[str, Any] = {"Frame": Frame, "Rotation": Rotation, "Vector": Vector}
"""Contents of ``PyKDL``."""
POSEMATH: dict[str, Any] = {"fromMsg": from_msg, "toMsg": to_msg}
"""Contents of ``tf_conversions.posemath`` and of ``tf_conversions``."""
TRANSFORMATIONS: dict[str, Any] = {
    "euler_from_quaternion": euler_from_quaternion,
    "quaternion_from_euler": quaternion_from_euler,
}
"""Contents of ``tf.transformations``."""
