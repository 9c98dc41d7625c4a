"""Minimum-jerk curves of one or two coordinates, with their derivatives.

Flash, Hogan, "The coordination of arm movements", Journal of Neuroscience 1985.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np

Q = TypeVar("Q", float, np.ndarray)


def quintic_progress(s: float) -> tuple[float, float, float]:
    """Computes 10s³ - 15s⁴ + 6s⁵ with its first and second derivative."""
    r = 1.0 - s
    return (
        s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
        30.0 * s * s * r * r,
        60.0 * s * r * (r - s),
    )


def rise_and_fall(s: float, apex: float) -> tuple[float, float, float]:
    """Computes a bump from 0 through 1 at ``apex`` to 0, with two derivatives in s.

    Two minimum-jerk quintics that meet at rest; s grows from 0 to 1.
    """
    if s < apex:
        r, dr, ddr = quintic_progress(s / apex)
        return r, dr / apex, ddr / apex**2
    fall = 1.0 - apex
    r, dr, ddr = quintic_progress((1.0 - s) / fall)
    return r, -dr / fall, ddr / fall**2


def quintic_step(
    p: np.ndarray, v: np.ndarray, a: np.ndarray, goal: np.ndarray, T: float, dt: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Advances by ``dt`` on the quintic from (p, v, a) to rest at ``goal`` in ``T``."""
    # Two components: as numbers they cost a third of the time of small arrays.
    parts = zip(p.tolist(), v.tolist(), a.tolist(), goal.tolist(), strict=True)
    moved = [quintic_step_of_one(*part, T, dt) for part in parts]
    p_next, v_next, a_next = zip(*moved, strict=True)
    return np.array(p_next), np.array(v_next), np.array(a_next)


def quintic_coefficients(p: Q, v: Q, a: Q, goal: Q, T: float) -> tuple[Q, Q, Q]:
    """Coefficients of t³, t⁴, t⁵ on the quintic from (p, v, a) to rest at ``goal``."""
    d = goal - p - v * T - 0.5 * a * T * T
    e = -(v + a * T) * T
    f = -0.5 * a * T * T
    return (
        (10.0 * d - 4.0 * e + f) / T**3,
        (-15.0 * d + 7.0 * e - 2.0 * f) / T**4,
        (6.0 * d - 3.0 * e + f) / T**5,
    )


def quintic_step_of_one(
    p: float, v: float, a: float, goal: float, T: float, dt: float
) -> tuple[float, float, float]:
    """Advances one coordinate as ``quintic_step``."""
    c3, c4, c5 = quintic_coefficients(p, v, a, goal, T)
    t = dt
    return (
        p + t * (v + t * (0.5 * a + t * (c3 + t * (c4 + t * c5)))),
        v + t * (a + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5))),
        a + t * (6.0 * c3 + t * (12.0 * c4 + t * 20.0 * c5)),
    )
