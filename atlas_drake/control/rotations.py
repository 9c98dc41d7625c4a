"""Small rotation helpers on plain arrays, for code that runs every control tick.

Written out on floats because numpy's general routines cost ten times as much on
vectors of three. Not a geometry library: pydrake.math serves everything else.
"""

from __future__ import annotations

import math

import numpy as np


def rotation_error(R_WD: np.ndarray, R_WB: np.ndarray) -> np.ndarray:
    """Rotation that takes B to D, as sin(angle) times its axis in W.

    Args:
        R_WD: Desired orientation, shape (3, 3).
        R_WB: Actual orientation, shape (3, 3).

    Returns:
        The error [rad for small angles], shape (3,).
    """
    (_, xy, xz), (yx, _, yz), (zx, zy, _) = (R_WD @ R_WB.T).tolist()
    return np.array([0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)])


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The vector product of two vectors of shape (3,)."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def yaw_of(R: np.ndarray) -> float:
    """Heading of the x axis of a rotation matrix about the world's z [rad]."""
    return math.atan2(R[1, 0], R[0, 0])


def rotation_z(yaw: float) -> np.ndarray:
    """Rotation by ``yaw`` [rad] about z, shape (3, 3)."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_y(pitch: float) -> np.ndarray:
    """Rotation by ``pitch`` [rad] about y, shape (3, 3)."""
    c, s = math.cos(pitch), math.sin(pitch)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rotation_with_normal(yaw: float, normal: np.ndarray) -> np.ndarray:
    """Orientation whose z is ``normal`` and whose x heads along ``yaw``.

    Args:
        yaw: Heading of x about the world's z [rad].
        normal: Unit vector in W, shape (3,), not horizontal along the heading.
    """
    heading = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    x = heading - normal * (normal @ heading)
    x /= math.sqrt(x @ x)
    y = np.array(
        [
            normal[1] * x[2] - normal[2] * x[1],
            normal[2] * x[0] - normal[0] * x[2],
            normal[0] * x[1] - normal[1] * x[0],
        ]
    )
    return np.column_stack([x, y, normal])


def wrap_angle(angle: float) -> float:
    """The same angle in [-π, π) [rad]."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def mean_yaw(yaw_a: float, yaw_b: float) -> float:
    """The heading halfway between two headings [rad]."""
    return wrap_angle(yaw_a + 0.5 * wrap_angle(yaw_b - yaw_a))
