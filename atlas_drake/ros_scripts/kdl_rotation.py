"""``PyKDL.Rotation``, on Drake's rotation matrices.

The names and conventions are those of the Orocos library.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.common.eigen_geometry import Quaternion as DrakeQuaternion
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.ros_scripts.kdl_vector import Vector


class Rotation:
    """A rotation."""

    def __init__(self, *elements: Any) -> None:
        """Makes a rotation of nine numbers by rows, 3 axes, a rotation, or nothing."""
        if not elements:
            self.R = RotationMatrix()
        elif len(elements) == 1 and isinstance(elements[0], Rotation):
            self.R = elements[0].R
        elif len(elements) == 9:
            rows = np.array([float(number) for number in elements]).reshape(3, 3)
            self.R = RotationMatrix.ProjectToRotationMatrix(rows)
        elif all(isinstance(axis, Vector) for axis in elements) and len(elements) == 3:
            columns = np.column_stack([axis.array for axis in elements])
            self.R = RotationMatrix.ProjectToRotationMatrix(columns)
        else:
            raise TypeError(
                "PyKDL.Rotation takes 9 numbers, 3 vectors, a rotation or nothing"
            )

    @classmethod
    def of(cls, R: RotationMatrix) -> Rotation:
        """Converts Drake's rotation matrix."""
        result = cls()
        result.R = R
        return result

    @staticmethod
    def Identity() -> Rotation:
        """Returns no rotation."""
        return Rotation()

    @staticmethod
    def Quaternion(x: float, y: float, z: float, w: float) -> Rotation:
        """Returns the rotation of a quaternion; no rotation for one of zeros."""
        wxyz = np.array([w, x, y, z], dtype=float)
        norm = np.linalg.norm(wxyz)
        if not norm > 0.0:
            return Rotation()
        return Rotation.of(RotationMatrix(DrakeQuaternion(wxyz / norm)))

    @staticmethod
    def RPY(roll: float, pitch: float, yaw: float) -> Rotation:
        """Returns the rotation about fixed x, then y, then z."""
        return Rotation.of(RotationMatrix(RollPitchYaw(roll, pitch, yaw)))

    @staticmethod
    def EulerZYX(alfa: float, beta: float, gamma: float) -> Rotation:
        """Returns the rotation about z, the new y, and the x after that."""
        return Rotation.RPY(gamma, beta, alfa)

    @staticmethod
    def RotX(angle: float) -> Rotation:
        """Returns a rotation about x."""
        return Rotation.of(RotationMatrix.MakeXRotation(angle))

    @staticmethod
    def RotY(angle: float) -> Rotation:
        """Returns a rotation about y."""
        return Rotation.of(RotationMatrix.MakeYRotation(angle))

    @staticmethod
    def RotZ(angle: float) -> Rotation:
        """Returns a rotation about z."""
        return Rotation.of(RotationMatrix.MakeZRotation(angle))

    @staticmethod
    def Rot(axis: Vector, angle: float) -> Rotation:
        """Returns a rotation about any axis, of any length but 0."""
        unit = axis.array / np.linalg.norm(axis.array)
        return Rotation.of(RotationMatrix(AngleAxis(angle, unit)))

    def GetQuaternion(self) -> tuple[float, float, float, float]:
        """Returns x, y, z, w."""
        w, x, y, z = (float(number) for number in self.R.ToQuaternion().wxyz())
        return x, y, z, w

    def GetRPY(self) -> tuple[float, float, float]:
        """Returns roll, pitch and yaw."""
        roll, pitch, yaw = RollPitchYaw(self.R).vector()
        return float(roll), float(pitch), float(yaw)

    def GetEulerZYX(self) -> tuple[float, float, float]:
        """Returns yaw, pitch and roll."""
        roll, pitch, yaw = self.GetRPY()
        return yaw, pitch, roll

    def GetRotAngle(self) -> tuple[float, Vector]:
        """Returns angle and axis."""
        turn = self.R.ToAngleAxis()
        return float(turn.angle()), Vector(turn.axis())

    def GetRot(self) -> Vector:
        """Returns the axis times the angle."""
        angle, axis = self.GetRotAngle()
        return axis * angle

    def UnitX(self) -> Vector:
        """Returns the x axis."""
        return Vector(self.R.col(0))

    def UnitY(self) -> Vector:
        """Returns the y axis."""
        return Vector(self.R.col(1))

    def UnitZ(self) -> Vector:
        """Returns the z axis."""
        return Vector(self.R.col(2))

    def Inverse(self) -> Rotation:
        """Returns the inverse."""
        return Rotation.of(self.R.inverse())

    def DoRotX(self, angle: float) -> None:
        """Turns about the own x axis."""
        self.R = self.R @ RotationMatrix.MakeXRotation(angle)

    def DoRotY(self, angle: float) -> None:
        """Turns about the own y axis."""
        self.R = self.R @ RotationMatrix.MakeYRotation(angle)

    def DoRotZ(self, angle: float) -> None:
        """Turns about the own z axis."""
        self.R = self.R @ RotationMatrix.MakeZRotation(angle)

    def __getitem__(self, place: tuple[int, int]) -> float:
        return float(self.R.matrix()[place])

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Rotation):
            return Rotation.of(self.R @ other.R)
        if isinstance(other, Vector):
            return Vector(self.R.matrix() @ other.array)
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rotation) and bool(
            (self.R.matrix() == other.R.matrix()).all()
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        rows = (", ".join(f"{x:12g}" for x in row) for row in self.R.matrix())
        return "[" + ";\n ".join(rows) + "]"
