"""Small rotation helpers on plain arrays, for code that runs every control tick.

Written out on floats because numpy's general routines cost ten times as much on
vectors of three. Not a geometry library: pydrake.math serves everything else.
"""

from __future__ import annotations

import math

import numpy as np


def rotation_error(R_WD: np.ndarray, R_WB: np.ndarray) -> np.ndarray:
    """Turn that takes B to D in W, as sines of its two angles, shape (3,).

    The z axis turns to its place the shorter way, and B turns about it, beyond 90° as
    at 90°. A body that a push has spun is so brought upright from where it leans. About
    the one axis of the whole turn it would be pushed aside, and after half a turn not
    be brought upright at all (reduced attitude: Chaturvedi, Sanyal, McClamroch,
    "Rigid-body attitude control", IEEE Control Systems Magazine 2011).
    """
    (xx, xy, xz), (yx, yy, yz), _ = (R_WD.T @ R_WB).tolist()
    # Sine and cosine of the turn about z, both times 1 + z_WB · z_WD.
    sine, cosine = xy - yx, xx + yy
    if cosine > 0.0:
        about = sine / math.hypot(sine, cosine)
    else:
        about = math.copysign(1.0, sine)
    return np.asarray(R_WD @ np.array([yz, -xz, about]))


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Computes the cross product of two vectors of shape (3,)."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def cross_rows(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Computes the cross products of rows, shape (n, 3), faster than numpy for few."""
    product = np.empty_like(a)
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    product[:, 0] = ay * bz - az * by
    product[:, 1] = az * bx - ax * bz
    product[:, 2] = ax * by - ay * bx
    return product


def yaw_of(R: np.ndarray) -> float:
    """Heading of the x axis of a rotation matrix about the world's z [rad]."""
    return math.atan2(R[1, 0], R[0, 0])


def rotation_z(yaw: float) -> np.ndarray:
    """Rotation by ``yaw`` [rad] about z, shape (3, 3)."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_x(roll: float) -> np.ndarray:
    """Rotation by ``roll`` [rad] about x, shape (3, 3)."""
    c, s = math.cos(roll), math.sin(roll)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rotation_y(pitch: float) -> np.ndarray:
    """Rotation by ``pitch`` [rad] about y, shape (3, 3)."""
    c, s = math.cos(pitch), math.sin(pitch)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def tilt_of(R: np.ndarray) -> np.ndarray:
    """Roll and pitch of a roll-pitch-yaw decomposition [rad], shape (2,)."""
    pitch = math.asin(min(max(-R[2, 0], -1.0), 1.0))
    return np.array([math.atan2(R[2, 1], R[2, 2]), pitch])


def orientation(yaw: float, tilt: np.ndarray) -> np.ndarray:
    """Computes the rotation of a yaw and a tilt, roll and pitch, about W's axes [rad].

    The inverse of ``yaw_of`` and ``tilt_of``.
    """
    roll, pitch = tilt.tolist()
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rotation_with_normal(yaw: float, normal: np.ndarray) -> np.ndarray:
    """Orientation whose z is a unit vector, not level, and whose x heads along yaw."""
    c, s = math.cos(yaw), math.sin(yaw)
    nx, ny, nz = normal.tolist()
    slope = -(c * nx + s * ny) / nz
    shrink = 1.0 / math.sqrt(1.0 + slope * slope)
    x, y, z = c * shrink, s * shrink, slope * shrink
    # The second column is the cross product of the third and the first.
    return np.array(
        [
            [x, ny * z - nz * y, nx],
            [y, nz * x - nx * z, ny],
            [z, nx * y - ny * x, nz],
        ]
    )


def rotation_vector(R: np.ndarray) -> np.ndarray:
    """Computes axis times angle of a rotation below half a turn [rad], shape (3,)."""
    (_, xy, xz), (yx, _, yz), (zx, zy, _) = R.tolist()
    sine_axis = 0.5 * np.array([zy - yz, xz - zx, yx - xy])
    sine = math.sqrt(sine_axis @ sine_axis)
    if sine == 0.0:
        return sine_axis
    angle = math.atan2(sine, 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0))
    return sine_axis * (angle / sine)


def rotation_about(vector: np.ndarray) -> np.ndarray:
    """Computes the rotation about ``vector`` by its length [rad], shape (3, 3)."""
    angle = math.sqrt(vector @ vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = (vector / angle).tolist()
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K)


def wrap_angle(angle: float) -> float:
    """Wraps an angle to [-π, π) [rad]."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def rotation_matrix(q_WB: np.ndarray) -> np.ndarray:
    """Converts a unit quaternion [w, x, y, z] to a rotation matrix, shape (3, 3)."""
    w, x, y, z = q_WB.tolist()
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def mean_yaw(yaw_a: float, yaw_b: float) -> float:
    """The heading halfway between two headings [rad]."""
    return wrap_angle(yaw_a + 0.5 * wrap_angle(yaw_b - yaw_a))
