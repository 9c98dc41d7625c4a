"""Mass properties of the two robots, one table each.

The skeleton they hang on is in `skeleton`. Limbs are listed for the left side and
mirrored for the right.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robot_models.parts import Inertial, Vector, mirror_inertial
from robot_models.skeleton import CAMERAS, LIMB_LINKS

CAMERA_MASS = 0.1
"""Mass of each camera on the chest [kg]."""

CAMERA_MOMENT = 1e-5
"""Moment of inertia of each camera about any axis through it [kg·m²]."""

HEAD = Inertial(
    1.41984,
    (-0.075493, 3.3383e-05, 0.02774),
    (0.0039688, 0.0041178, 0.0035243),
    (-1.5797e-06, -0.00089293, -6.8415e-07),
)
"""The sensor head, which is the same on both robots."""

# Moments and products of these links are the same in both tables of the original,
# although their masses differ.
_PELVIS = ((0.0111, 0.0, 0.0271), (0.1244, 0.0958, 0.1167), (0.0008, -0.0007, -0.0005))
_LTORSO = (
    (-0.0112984, -3.15366e-06, 0.0746835),
    (0.0039092, 0.00341694, 0.00174492),
    (-5.04491e-08, -0.000342157, 4.87119e-07),
)
_MTORSO = (
    (-0.00816266, -0.0131245, 0.0305974),
    (0.000454181, 0.000483282, 0.000444215),
    (-6.10764e-05, 3.94009e-05, 5.27463e-05),
)
_UGLUT = (
    (0.00529262, -0.00344732, 0.00313046),
    (0.00074276, 0.000688179, 0.00041242),
    (-3.79607e-08, -2.79549e-05, -3.2735e-08),
)
_LGLUT = (
    (0.0133341, 0.0170484, -0.0312052),
    (0.000691326, 0.00126856, 0.00106487),
    (-2.24344e-05, 2.50508e-06, 0.000137862),
)
_ULEG = ((0.0, 0.0, -0.21), (0.09, 0.09, 0.02))
_LLEG = ((0.001, 0.0, -0.187), (0.077, 0.076, 0.01), (0.0, -0.003, 0.0))
_TALUS = ((0.0, 0.0, 0.0), (1.01674e-05, 8.42775e-06, 1.30101e-05))
_FOOT = ((0.027, 0.0, -0.067), (0.002, 0.007, 0.008))

# Atlas v3 uses the same two figures for two arm links each.
_V3_UARM_FARM = ((0.0, -0.065, 0.0), (0.00656, 0.00358, 0.00656))
_V3_LARM_HAND = ((0.0, 0.0, 0.0), (0.00265, 0.00446, 0.00446))

_LIGHT = {
    "pelvis": Inertial(14.2529, *_PELVIS),
    "ltorso": Inertial(1.92, *_LTORSO),
    "mtorso": Inertial(0.55, *_MTORSO),
    "utorso": Inertial(
        18.484, (0.02, -0.001, 0.211), (0.395, 1.089, 0.827), (0.0, 0.083, -0.003)
    ),
    "head": HEAD,
    "uglut": Inertial(0.5166, *_UGLUT),
    "lglut": Inertial(0.69, *_LGLUT),
    "uleg": Inertial(7.34, *_ULEG),
    "lleg": Inertial(4.367, *_LLEG),
    "talus": Inertial(0.1, *_TALUS),
    "foot": Inertial(1.634, *_FOOT),
    "clav": Inertial(
        2.369, (0.014, 0.058, 0.029), (0.004, 0.006, 0.007), (0.001, 0.0, 0.0)
    ),
    "scap": Inertial(2.707, (-0.002, 0.108, 0.0), (0.01, 0.005, 0.013)),
    "uarm": Inertial(1.881, (0.007, 0.114, 0.008), (0.002, 0.003, 0.003)),
    "larm": Inertial(2.148, (-0.003, 0.099, -0.014), (0.005, 0.003, 0.006)),
    "farm": Inertial(0.981, (0.0, 0.041, 0.0), (0.003, 0.001, 0.003)),
    "hand": Inertial(2.263, (0.0, 0.093, 0.0), (0.01, 0.002, 0.01)),
}

_HEAVY = {
    "pelvis": Inertial(17.882, *_PELVIS),
    "ltorso": Inertial(2.409, *_LTORSO),
    "mtorso": Inertial(0.69, *_MTORSO),
    # With the battery backpack.
    "utorso": Inertial(
        52.007, (-0.0923, 0.0, 0.3), (1.466, 1.51, 1.3), (0.00362, 0.336, 0.001)
    ),
    "head": HEAD,
    "uglut": Inertial(0.648, *_UGLUT),
    "lglut": Inertial(0.866, *_LGLUT),
    "uleg": Inertial(9.209, *_ULEG),
    "lleg": Inertial(5.479, *_LLEG),
    "talus": Inertial(0.125, *_TALUS),
    "foot": Inertial(2.05, *_FOOT),
    "clav": Inertial(
        3.45, (0.0, 0.048, 0.084), (0.011, 0.009, 0.004), (0.0, 0.0, -0.004)
    ),
    "scap": Inertial(3.012, (0.0, 0.0, 0.0), (0.00319, 0.00583, 0.00583)),
    "uarm": Inertial(3.388, *_V3_UARM_FARM),
    "larm": Inertial(2.509, *_V3_LARM_HAND),
    "farm": Inertial(3.388, *_V3_UARM_FARM),
    "hand": Inertial(2.509, *_V3_LARM_HAND),
}


def combine(parts: list[Inertial]) -> Inertial:
    """Returns the mass properties of rigidly joined parts.

    Args:
        parts: Mass properties, all in the same frame.

    Returns:
        Their sum in that frame, by the parallel axis theorem.
    """
    mass = sum(part.mass for part in parts)
    centers = np.array([part.center_of_mass for part in parts])
    center = np.array([part.mass for part in parts]) @ centers / mass
    total = np.zeros((3, 3))
    for part, part_center in zip(parts, centers, strict=True):
        (ixx, iyy, izz), (ixy, ixz, iyz) = part.moments, part.products
        total += np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        arm = part_center - center
        total += part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertial(
        mass,
        _vector(center),
        _vector(np.diag(total)),
        _vector(total[(0, 0, 1), (1, 2, 2)]),
    )


def _vector(array: npt.NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in array)
    return (x, y, z)


def _complete(table: dict[str, Inertial]) -> dict[str, Inertial]:
    """Names both sides' limbs and adds the cameras' mass to the chest."""
    links: dict[str, Inertial] = {}
    for name, inertial in table.items():
        if name in LIMB_LINKS:
            links[f"l_{name}"] = inertial
            links[f"r_{name}"] = mirror_inertial(inertial)
        else:
            links[name] = inertial
    # A camera's inertia is the same about every axis, so its attitude is irrelevant.
    cameras = [
        Inertial(CAMERA_MASS, camera.xyz, (CAMERA_MOMENT,) * 3) for camera in CAMERAS
    ]
    links["utorso"] = combine([links["utorso"], *cameras])
    return links


LIGHT = _complete(_LIGHT)
"""Atlas v3 with the inertias of v1, by link: the robot of the tutorial's gains."""

HEAVY = _complete(_HEAVY)
"""Atlas v3 with its own inertias, by link: it carries a battery backpack."""
