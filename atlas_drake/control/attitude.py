"""Orientation from a gyroscope, with the tilt corrected by gravity.

A complementary filter: Mahony, Hamel, Pflimlin, "Nonlinear complementary filters on the
special orthogonal group", TAC 2008. Orientations are unit quaternions [w, x, y, z],
shape (4,), and turns are rotation vectors [rad], shape (3,). Written out on floats:
Drake's quaternions take twice as long.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.units import GRAVITY


def turned(q_WB: np.ndarray, turn_B: np.ndarray) -> np.ndarray:
    """Rotates an orientation about an axis fixed in B.

    Exact for any angle: the exponential map of SO(3).
    """
    return _normalized(_product(q_WB.tolist(), _exponential(turn_B)))


def turned_in_world(q_WB: np.ndarray, turn_W: np.ndarray) -> np.ndarray:
    """Rotates an orientation about an axis fixed in W; see ``turned``."""
    return _normalized(_product(_exponential(turn_W), q_WB.tolist()))


def turn_between(q_WA: np.ndarray, q_WB: np.ndarray) -> np.ndarray:
    """Computes the shortest turn from A to B, the same in A and in B."""
    w, x, y, z = q_WA.tolist()
    w, x, y, z = _product((w, -x, -y, -z), q_WB.tolist())
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 0.0 else 2.0
    return np.array([scale * x, scale * y, scale * z])


def composed(q_WA: np.ndarray, q_AB: np.ndarray) -> np.ndarray:
    """Composes two orientations to q_WB; w of the result is not negative."""
    q_WB = _normalized(_product(q_WA.tolist(), q_AB.tolist()))
    return -q_WB if q_WB[0] < 0.0 else q_WB


def upright_correction(force_W: np.ndarray, dt: float, settling: float) -> np.ndarray:
    """Computes a small turn in W that brings the specific force nearer to the vertical.

    A first-order filter corrects an error of tilt with the time constant ``settling``
    [s] and leaves the heading alone. The motion of the robot disturbs the tilt by its
    change of horizontal velocity divided by ``settling`` and gravity, because the rest
    of the specific force is gravity itself: walking at 0.5 m/s disturbs the tilt by no
    more than half a milliradian at 100 s. The filter therefore needs no detection of
    rest. ``force_W`` is 9.81 m/s² upward for a robot at rest.
    """
    x, y, _ = force_W.tolist()
    gain = dt / (settling * GRAVITY)
    return np.array([gain * y, -gain * x, 0.0])


_Quaternion = tuple[float, float, float, float]


def _product(a: list[float] | _Quaternion, b: list[float] | _Quaternion) -> _Quaternion:
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def _exponential(turn: np.ndarray) -> _Quaternion:
    x, y, z = turn.tolist()
    angle = math.sqrt(x * x + y * y + z * z)
    scale = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    return math.cos(0.5 * angle), scale * x, scale * y, scale * z


def _normalized(quaternion: _Quaternion) -> np.ndarray:
    q = np.array(quaternion)
    return q / math.sqrt(q @ q)
