"""Inverse of the whole robot's spatial inertia, which eliminates the pelvis."""

from __future__ import annotations

import numpy as np


def inverse_inertia(M_base: np.ndarray, mass: float) -> np.ndarray:
    """Inverts the whole robot's spatial inertia about the pelvis' origin.

    With c from the pelvis' origin to the center of mass and the rotational inertia I_c
    about the center of mass, in W,

        [I_c + m [c]ᵀ[c]  m [c]]⁻¹   [    I_c⁻¹         -I_c⁻¹ [c]      ]
        [     m [c]ᵀ        m 1]   = [ -[c]ᵀ I_c⁻¹  1/m + [c]ᵀ I_c⁻¹ [c] ]

    where [c] is the matrix of c ×. Written out on floats: a general solver takes
    twice as long for a matrix of this size.

    Args:
        M_base: Pelvis' part of the mass matrix, [angular; translational], (6, 6).
        mass: Total mass m [kg].
    """
    angular = M_base[:3].tolist()
    (xx, xy, xz, _, _, y), (_, yy, yz, z, _, _), (_, _, zz, _, x, _) = angular
    x, y, z = x / mass, y / mass, z / mass
    xx -= mass * (y * y + z * z)
    yy -= mass * (x * x + z * z)
    zz -= mass * (x * x + y * y)
    xy += mass * x * y
    xz += mass * x * z
    yz += mass * y * z
    # Inverse of I_c by its adjugate.
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    scale = 1.0 / (xx * a + xy * b + xz * c)
    a, b, c = scale * a, scale * b, scale * c
    d, e, f = scale * d, scale * e, scale * f
    # K = -I_c⁻¹ [c], and the symmetric 1/m - [c]ᵀ K.
    k00, k01, k02 = c * y - b * z, a * z - c * x, b * x - a * y
    k10, k11, k12 = e * y - d * z, b * z - e * x, d * x - b * y
    k20, k21, k22 = f * y - e * z, c * z - f * x, e * x - c * y
    n = 1.0 / mass
    p, q, r = n + y * k20 - z * k10, y * k21 - z * k11, y * k22 - z * k12
    s, t, u = n + z * k01 - x * k21, z * k02 - x * k22, n + x * k12 - y * k02
    return np.array(
        [
            [a, b, c, k00, k01, k02],
            [b, d, e, k10, k11, k12],
            [c, e, f, k20, k21, k22],
            [k00, k10, k20, p, q, r],
            [k01, k11, k21, q, s, t],
            [k02, k12, k22, r, t, u],
        ]
    )
