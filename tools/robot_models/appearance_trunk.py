"""Appearance of pelvis, trunk and head, as surfaces by link and material.

Arms and legs are in `appearance_limbs`; nothing here takes part in the physics.
"""

from __future__ import annotations

from robot_models.collisions import Backpack
from robot_models.forms import block, drum, hull, rod
from robot_models.parts import Vector, mirror_point
from robot_models.surfaces import Loft, Panel, Surface, Tube

CAGE_RADIUS = 0.008
"""Radius of the tubes around head and pelvis [m]."""


def both(surfaces: tuple[Tube, ...]) -> tuple[Tube, ...]:
    """Returns tubes and their mirror images in the plane y = 0."""
    return surfaces + tuple(
        Tube(tuple(map(mirror_point, tube.points)), tube.radius) for tube in surfaces
    )


_BELT_HALF: tuple[Vector, ...] = (
    (0.122, 0.0, 0.045),
    (0.118, 0.060, 0.045),
    (0.098, 0.118, 0.050),
    (0.040, 0.152, 0.055),
    (-0.050, 0.150, 0.055),
    (-0.112, 0.105, 0.050),
    (-0.118, 0.0, 0.045),
)
_BELT = _BELT_HALF + tuple(mirror_point(point) for point in _BELT_HALF[-2::-1])

_FRONT_COVER = hull(
    "y",
    (
        (-0.088, (0.084, 0.040), (0.014, 0.020)),
        (-0.045, (0.108, 0.036), (0.018, 0.032)),
        (0.0, (0.116, 0.034), (0.020, 0.036)),
        (0.045, (0.108, 0.036), (0.018, 0.032)),
        (0.088, (0.084, 0.040), (0.014, 0.020)),
    ),
    power=3.0,
    rims=(0.008, 0.008),
)

PELVIS: dict[str, tuple[Surface, ...]] = {
    "graphite": (
        hull(
            "z",
            (
                (-0.085, (-0.035, 0.0), (0.045, 0.035)),
                (-0.03, (-0.03, 0.0), (0.075, 0.055)),
                (0.04, (-0.025, 0.0), (0.09, 0.075)),
                (0.075, (-0.0125, 0.0), (0.07, 0.07)),
            ),
            power=3.5,
        ),
        drum("z", (0.0, 0.089, 0.055), 0.046, 0.09),
        drum("z", (0.0, -0.089, 0.055), 0.046, 0.09),
        block("y", (-0.01, 0.0, 0.04), (0.10, 0.26, 0.05)),
    ),
    "steel": (
        Tube(_BELT, CAGE_RADIUS),
        *both(
            (
                rod((0.118, 0.060, 0.045), (0.02, 0.035, -0.02), CAGE_RADIUS),
                rod((0.098, 0.118, 0.050), (0.02, 0.100, 0.04), CAGE_RADIUS),
                rod((-0.112, 0.105, 0.050), (-0.03, 0.10, 0.04), CAGE_RADIUS),
            )
        ),
    ),
    "shell": (
        block("z", (-0.115, 0.0, 0.005), (0.045, 0.17, 0.13), rim=0.015),
        _FRONT_COVER,
        drum("z", (0.0, 0.089, 0.106), 0.038, 0.02),
        drum("z", (0.0, -0.089, 0.106), 0.038, 0.02),
    ),
}

LTORSO: dict[str, tuple[Surface, ...]] = {
    "graphite": (
        drum("z", (0.0, 0.0, 0.09), 0.058, 0.07),
        hull(
            "z",
            (
                (0.11, (-0.005, 0.0), (0.045, 0.05)),
                (0.19, (0.0, 0.0), (0.035, 0.045)),
            ),
        ),
    ),
    "steel": (
        rod((-0.065, 0.05, 0.06), (-0.06, 0.05, 0.20), 0.013),
        rod((-0.065, -0.05, 0.06), (-0.06, -0.05, 0.20), 0.013),
    ),
}

MTORSO: dict[str, tuple[Surface, ...]] = {
    "graphite": (
        drum("y", (0.0, 0.0, 0.0), 0.04, 0.15),
        drum("x", (0.0, 0.0, 0.05), 0.038, 0.15),
    ),
    "accent": (drum("y", (0.0, 0.0, 0.0), 0.022, 0.158, rim=0.003),),
}

_CHEST = Loft(
    "z",
    hull(
        "z",
        (
            (-0.005, (0.005, 0.0), (0.100, 0.120)),
            (0.09, (0.012, 0.0), (0.132, 0.148)),
            (0.22, (0.022, 0.0), (0.165, 0.182)),
            (0.34, (0.028, 0.0), (0.172, 0.212)),
            (0.44, (0.026, 0.0), (0.152, 0.205)),
            (0.505, (0.020, 0.0), (0.118, 0.165)),
        ),
        power=2.9,
    ).sections,
    fillet=(0.02, 0.04),
    segments=48,
    rings=14,
)

_PLATE_LIFT = 0.007  # Height of the breastplates above the chest [m].
_VENTS = (0.035, 0.075, 0.115, 0.155)  # Lower edges of the slats below the chest.

_CAGE_SIDE: tuple[Vector, ...] = (
    (0.135, 0.128, 0.455),
    (0.222, 0.132, 0.535),
    (0.238, 0.128, 0.630),
    (0.190, 0.120, 0.705),
    (0.090, 0.117, 0.728),
    (-0.010, 0.120, 0.700),
    (-0.062, 0.128, 0.610),
    (-0.075, 0.135, 0.470),
)
_CAGE_BARS = (3, 5)  # Points of the side where bars run across.


def _hull_of(pack: Backpack) -> Loft:
    across = pack.center[:2]
    depth, width = pack.depth / 2, pack.width / 2
    return hull(
        "z",
        (
            (pack.bottom, across, (depth, 0.86 * width)),
            ((pack.bottom + pack.top) / 2, across, (depth, width)),
            (pack.top, across, (depth, 0.92 * width)),
        ),
        power=4.5,
        rims=(0.03, 0.035),
    )


def utorso(backpack: Backpack) -> dict[str, tuple[Surface, ...]]:
    """Returns the chest's surfaces with a backpack."""
    pack, bottom, top = _hull_of(backpack), backpack.bottom, backpack.top
    return {
        "shell": (
            _CHEST,
            Panel(_CHEST, (0.230, 0.440), (1.5, 67.0), lift=_PLATE_LIFT, rings=8),
            Panel(_CHEST, (0.230, 0.440), (-67.0, -1.5), lift=_PLATE_LIFT, rings=8),
            Panel(
                pack, (bottom + 0.05, top - 0.05), (125.0, 235.0), lift=0.006, rings=8
            ),
        ),
        "graphite": (
            pack,
            *(Panel(_CHEST, (low, low + 0.026), (-26.0, 26.0)) for low in _VENTS),
            Panel(
                _CHEST, (0.224, 0.446), (-68.5, 68.5), lift=0.002, segments=32, rings=8
            ),
            drum("x", (0.0, 0.0, 0.0), 0.062, 0.15),
            hull(
                "x",
                (
                    (0.07, (0.0, 0.47), (0.05, 0.03)),
                    (0.205, (0.0, 0.525), (0.03, 0.02)),
                ),
                power=4.0,
            ),
        ),
        "accent": (
            Panel(_CHEST, (0.385, 0.401), (9.0, 59.0), lift=_PLATE_LIFT + 0.002),
            Panel(_CHEST, (0.385, 0.401), (-59.0, -9.0), lift=_PLATE_LIFT + 0.002),
            Panel(pack, (top - 0.13, top - 0.11), (128.0, 232.0), lift=0.009),
        ),
        "steel": (
            *both((Tube(_CAGE_SIDE, CAGE_RADIUS),)),
            *(
                rod(mirror_point(_CAGE_SIDE[bar]), _CAGE_SIDE[bar], CAGE_RADIUS)
                for bar in _CAGE_BARS
            ),
        ),
    }


HEAD: dict[str, tuple[Surface, ...]] = {
    "graphite": (
        hull(
            "z",
            (
                (-0.02, (-0.065, 0.0), (0.060, 0.060)),
                (0.05, (-0.065, 0.0), (0.085, 0.080)),
                (0.135, (-0.070, 0.0), (0.070, 0.066)),
            ),
            power=3.0,
            rims=(0.015, 0.03),
        ),
        drum("y", (0.0, 0.0, 0.0), 0.028, 0.10),
        drum("x", (0.0, 0.0, 0.015), 0.054, 0.08, rim=0.015),
    ),
    "shell": (block("y", (-0.005, 0.0, 0.098), (0.08, 0.205, 0.062), rim=0.018),),
    "lens": (
        drum("x", (0.034, 0.066, 0.098), 0.021, 0.02),
        drum("x", (0.034, -0.066, 0.098), 0.021, 0.02),
        block("x", (0.036, 0.0, 0.098), (0.01, 0.055, 0.034), rim=0.003),
        drum("x", (0.040, 0.0, 0.015), 0.037, 0.012, rim=0.004),
    ),
    "accent": (drum("x", (0.020, 0.0, 0.015), 0.0565, 0.008, rim=0.003),),
}
