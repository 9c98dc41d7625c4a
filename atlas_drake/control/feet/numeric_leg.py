"""Inverse kinematics of a leg of any six revolute joints, by Newton's method.

Forward kinematics is a product of exponentials (Murray, Li, Sastry, "A Mathematical
Introduction to Robotic Manipulation", 1994, chapter 3). ``leg_kinematics`` has the
closed form for legs of the one layout that has it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.feet.leg_pose import LegPose
from atlas_drake.robot import KNEE, Leg
from atlas_drake.rotations import cross_rows

_ACCURACY = 1e-5
"""Accuracy of the sole's pose [m], [rad]."""
_CONVERGES = 0.1
"""Share of the error that a step may leave before the Jacobian is computed anew [-]."""
_STALLS = 0.9
"""Share of the error that a step with a new Jacobian leaves if the sole is out of reach
[-]."""
_LONGEST_STEP = 0.5
"""Largest change of a joint in one step [rad]."""
_MOST_STEPS = 30
_DAMPING = 1e-4
"""Damping of the inverse Jacobian: steps stay finite where the leg is straight [-]."""


@dataclass(frozen=True)
class NumericPose(LegPose):
    """A pose from which others nearby are found."""

    inverse: np.ndarray  # Of the Jacobian here or nearby, (6, 6)


class NumericLeg:
    """Solves one leg. Holds constants only."""

    def __init__(self, leg: Leg) -> None:
        self._leg = leg
        self._axes = leg.axes[:, :, None]
        self._points = np.column_stack([leg.points, np.ones(len(leg.points))])[
            ..., None
        ]
        # A joint at q moves what is beyond it by E + sin(q) S + cos(q) C.
        self._E, self._S, self._C = np.zeros((3, len(leg.axes), 4, 4))
        for i, (axis, point) in enumerate(zip(leg.axes, leg.points, strict=True)):
            K = np.cross(np.eye(3), axis)
            KK = K @ K
            self._E[i, :3, :3] = np.eye(3) + KK
            self._E[i, :3, 3] = -KK @ point
            self._E[i, 3, 3] = 1.0
            self._S[i, :3, :3] = K
            self._S[i, :3, 3] = -K @ point
            self._C[i, :3, :3] = -KK
            self._C[i, :3, 3] = KK @ point
        self._home = self.pose(leg.seed)

    def _moves(self, angles: np.ndarray) -> np.ndarray:
        s, c = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
        moves: np.ndarray = self._E + s * self._S + c * self._C
        return moves

    def sole(self, angles: np.ndarray) -> np.ndarray:
        """Computes the sole's pose in the pelvis, shape (4, 4), for joints [rad]."""
        a, b, c, d, e, f = self._moves(angles)
        X: np.ndarray = a.dot(b).dot(c).dot(d).dot(e).dot(f).dot(self._leg.sole)
        return X

    def pose(self, angles: np.ndarray) -> NumericPose:
        """Computes axes and points of the joints, in the pelvis, for joints [rad]."""
        axes, points, p_PF = self._lines(angles)
        return NumericPose(angles, axes, points, _inverse(axes, p_PF - points))

    def _lines(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Computes axes, points on them, and the sole's place in the pelvis."""
        moves = self._moves(angles)
        above = np.empty_like(moves)
        X = np.eye(4)
        for i, move in enumerate(moves):
            above[i] = X
            X = X.dot(move)
        axes = (above[:, :3, :3] @ self._axes)[..., 0]
        points = (above[:, :3] @ self._points)[..., 0]
        return axes, points, X.dot(self._leg.sole)[:3, 3]

    def solve(
        self, p_PF: np.ndarray, R_PF: np.ndarray, near: LegPose | None = None
    ) -> LegPose | None:
        """Solves the inverse kinematics for a pose of the sole, knee bent forward.

        Begins at a pose that this method returned, or at the stand-prep pose. Returns
        None if no pose is found.
        """
        start = near if isinstance(near, NumericPose) else self._home
        angles, inverse = start.angles, start.inverse
        before, fresh = math.inf, False
        for _ in range(_MOST_STEPS):
            X = self.sole(angles)
            error = np.concatenate((_turn(R_PF.dot(X[:3, :3].T)), p_PF - X[:3, 3]))
            size = math.sqrt(error @ error)
            if size < _ACCURACY:
                bent = self._leg.flexion(float(angles[KNEE]))
                if math.remainder(bent, math.tau) < 0.0:
                    return None
                return NumericPose(angles, *self._lines(angles)[:2], inverse)
            if size > _CONVERGES * before:
                if fresh and size > _STALLS * before:
                    return None
                inverse, fresh = self.pose(angles).inverse, True
            else:
                fresh = False
            before = size
            step = inverse.dot(error)
            longest = max(step.max(), -step.min())
            if longest > _LONGEST_STEP:
                step *= _LONGEST_STEP / longest
            angles = angles + step
        return None


def _inverse(axes: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Computes the change of the joints per rotation and displacement of the sole.

    ``arms`` reach from points on the axes to the sole [m], shape (6, 3).
    """
    J = np.vstack([axes.T, cross_rows(axes, arms).T])
    inverse: np.ndarray = J.T @ np.linalg.inv(J @ J.T + _DAMPING**2 * np.eye(6))
    return inverse


def _turn(R: np.ndarray) -> tuple[float, float, float]:
    """Computes the rotation vector of R."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = R.tolist()
    x, y, z = 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)
    sine = math.sqrt(x * x + y * y + z * z)
    cosine, longer = 0.5 * (xx + yy + zz - 1.0), 1.0
    if sine > 1e-9:
        longer = math.atan2(sine, cosine) / sine
    elif cosine < 0.0:
        return math.pi, 0.0, 0.0  # A half turn; any way out of it will do.
    return longer * x, longer * y, longer * z
