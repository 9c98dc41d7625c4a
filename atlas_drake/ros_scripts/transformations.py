"""``tf_conversions.posemath`` and ``tf.transformations`` as far as poses go.

Quaternions are x, y, z, w. Euler angles are roll, pitch, yaw about fixed axes ("sxyz"),
the default convention of the original. Computed with Drake's math.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.ros_scripts.kdl_frame import Frame
from atlas_drake.ros_scripts.kdl_rotation import Rotation
from atlas_drake.ros_scripts.kdl_vector import Vector
from atlas_drake.ros_scripts.message_types import geometry_msgs
from atlas_drake.ros_scripts.unknown import unknown

AXES = "sxyz"
"""The convention of Euler angles."""


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


def from_tf(pose: Sequence[Any]) -> Frame:
    """Return the Frame of a pair: position, quaternion."""
    position, quaternion = pose
    return Frame(Rotation.Quaternion(*quaternion), Vector(*position))


def to_tf(frame: Frame) -> tuple[Any, Any]:
    """Return the pair of a Frame: position, quaternion."""
    return tuple(frame.p), frame.M.GetQuaternion()


def from_matrix(matrix: Any) -> Frame:
    """Return the Frame of a homogeneous matrix, shape (4, 4)."""
    return Frame.of(RigidTransform(np.asarray(matrix, dtype=float)))


def to_matrix(frame: Frame) -> np.ndarray:
    """Return the homogeneous matrix of a Frame, shape (4, 4)."""
    return np.asarray(frame.transform().GetAsMatrix4())


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


def euler_from_matrix(matrix: Any, axes: str = AXES) -> tuple[float, float, float]:
    """Return roll, pitch, yaw of a matrix, shape (3, 3) or (4, 4)."""
    _check(axes)
    return _rotation(matrix).GetRPY()


def euler_matrix(roll: float, pitch: float, yaw: float, axes: str = AXES) -> np.ndarray:
    """Return the homogeneous matrix of a rotation, shape (4, 4)."""
    _check(axes)
    return to_matrix(Frame(Rotation.RPY(roll, pitch, yaw)))


def quaternion_matrix(quaternion: Sequence[float]) -> np.ndarray:
    """Return the homogeneous matrix of a quaternion, shape (4, 4)."""
    return to_matrix(Frame(Rotation.Quaternion(*quaternion)))


def quaternion_from_matrix(matrix: Any) -> np.ndarray:
    """Return x, y, z, w of a matrix, shape (3, 3) or (4, 4)."""
    return np.array(_rotation(matrix).GetQuaternion())


def quaternion_about_axis(angle: float, axis: Sequence[float]) -> np.ndarray:
    """Return x, y, z, w of a rotation about an axis."""
    return np.array(Rotation.Rot(Vector(*axis), angle).GetQuaternion())


def quaternion_multiply(one: Sequence[float], other: Sequence[float]) -> np.ndarray:
    """Return the product: first ``other``, then ``one``."""
    product = Rotation.Quaternion(*one) * Rotation.Quaternion(*other)
    return np.array(product.GetQuaternion())


def quaternion_inverse(quaternion: Sequence[float]) -> np.ndarray:
    """Return the rotation back."""
    return np.array(Rotation.Quaternion(*quaternion).Inverse().GetQuaternion())


def translation_matrix(direction: Sequence[float]) -> np.ndarray:
    """Return the homogeneous matrix of a displacement, shape (4, 4)."""
    return to_matrix(Frame(Vector(*direction)))


def _rotation(matrix: Any) -> Rotation:
    rows = np.asarray(matrix, dtype=float)[:3, :3]
    return Rotation.of(RotationMatrix.ProjectToRotationMatrix(rows))


def _check(axes: str) -> None:
    if axes != AXES:
        raise unknown(f"the convention {axes!r} of Euler angles", axes, [AXES])


POSEMATH: dict[str, Any] = {
    "fromMsg": from_msg,
    "toMsg": to_msg,
    "fromTf": from_tf,
    "toTf": to_tf,
    "fromMatrix": from_matrix,
    "toMatrix": to_matrix,
}
"""Contents of ``tf_conversions.posemath`` and of ``tf_conversions``."""
TRANSFORMATIONS: dict[str, Any] = {
    function.__name__: function
    for function in (
        euler_from_matrix,
        euler_from_quaternion,
        euler_matrix,
        quaternion_about_axis,
        quaternion_from_euler,
        quaternion_from_matrix,
        quaternion_inverse,
        quaternion_matrix,
        quaternion_multiply,
        translation_matrix,
    )
}
"""Contents of ``tf.transformations``."""
