"""Angular momentum of legs and trunk, as the distance of the CMP from the CoP.

The centroidal moment pivot (CMP) is where the CoP would be without a rate L̇ of the
angular momentum about the center of mass (Popovic, Goswami, Herr, "Ground reference
points in legged locomotion", IJRR 2005). With the weight m·g on the feet

    CMP - CoP = [L̇_y, -L̇_x] / (m·g)

What the legs need is known before the QP is solved: L = A q̇ with the centroidal
momentum matrix A (Orin, Goswami, Lee, "Centroidal dynamics of a humanoid robot",
Autonomous Robots 2013), and the joints of a leg follow its sole.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.units import GRAVITY

_BASE = 6
"""Velocities of the pelvis, which precede those of the joints."""
_DAMPING = 0.02**2 * np.eye(6)
"""Of a leg's inverse: a straight knee moves no sole along the leg."""


def legs_offset(
    terms: WholeBodyTerms,
    legs: Sequence[np.ndarray | None],
    soles: Sequence[np.ndarray],
    com_acceleration: np.ndarray,
) -> np.ndarray:
    """Computes the part of both legs in CMP - CoP, horizontal in W [m], shape (2,).

    Args:
        terms: Model terms.
        legs: Joints of the left and the right leg in message order, each of shape (6,);
            None for a leg whose motion is not known.
        soles: Spatial accelerations of both soles [rad/s²; m/s²], each of shape (6,).
        com_acceleration: Of the center of mass, horizontal [m/s²], shape (2,).
    """
    moving = [foot for foot, joints in enumerate(legs) if joints is not None]
    if not moving:
        return np.zeros(2)
    relative = np.array([soles[foot] - terms.feet[foot].bias for foot in moving])
    relative[:, 3:5] -= com_acceleration
    columns = [_BASE + joints for joints in legs if joints is not None]
    joints = _inverse(terms, columns, moving, relative)
    return _offset(terms, np.concatenate(columns), joints.ravel())


def swing_inertia(
    terms: WholeBodyTerms, legs: Sequence[np.ndarray]
) -> tuple[float, float]:
    """Computes CMP - CoP for a foot that is accelerated by 1 m/s² [s²].

    Ahead, and to the left, of a robot at rest whose pelvis has the axes of W; the mean
    of both legs. Both are negative: the CMP stays behind.
    """
    columns = [_BASE + joints for joints in legs]

    def mean(axis: int) -> float:
        soles = np.tile(np.eye(6)[3 + axis], (len(legs), 1))
        joints = _inverse(terms, columns, range(len(legs)), soles)
        offset = _offset(terms, np.concatenate(columns), joints.ravel())
        return float(offset[axis]) / len(legs)

    return mean(0), mean(1)


def trunk_inertia(
    terms: WholeBodyTerms, legs: Sequence[np.ndarray]
) -> tuple[float, float]:
    """Computes the inertia of trunk and arms about x and y, per weight [m·s²/rad].

    About the center of mass of a robot at rest, on legs whose soles stay where they
    are.
    """
    columns = [_BASE + joints for joints in legs]

    def about(axis: int) -> float:
        turn = np.eye(_BASE)[axis]
        soles = np.array([-sole.J_WF[:, :_BASE] @ turn for sole in terms.feet])
        joints = _inverse(terms, columns, range(len(legs)), soles)
        moving = np.concatenate([np.arange(_BASE), *columns])
        offset = _offset(terms, moving, np.concatenate([turn, joints.ravel()]))
        return abs(float(offset[1 - axis]))

    return about(0), about(1)


def _offset(
    terms: WholeBodyTerms, columns: np.ndarray, acceleration: np.ndarray
) -> np.ndarray:
    """Computes the part of some accelerations in CMP - CoP [m], shape (2,)."""
    M = terms.M
    about_x, about_y = (M[:2, columns] @ acceleration).tolist()
    f_x, f_y, f_z = (M[3:6, columns] @ acceleration).tolist()
    x, y, z = (terms.com - terms.p_WP).tolist()
    L_x, L_y = about_x + z * f_y - y * f_z, about_y + x * f_z - z * f_x
    return np.array([L_y, -L_x]) / (terms.mass * GRAVITY)


def _inverse(
    terms: WholeBodyTerms,
    columns: Sequence[np.ndarray],
    feet: Iterable[int],
    soles: np.ndarray,
) -> np.ndarray:
    """Computes accelerations of legs' joints that move their soles, shape (k, 6)."""
    J = np.array(
        [terms.feet[foot].J_WF[:, own] for foot, own in zip(feet, columns, strict=True)]
    )
    J_T = J.transpose(0, 2, 1)
    joints: np.ndarray = J_T @ np.linalg.solve(J @ J_T + _DAMPING, soles[:, :, None])
    return joints[:, :, 0]
