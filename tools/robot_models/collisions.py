"""Collision shapes of both robots, and which pairs of links never collide.

Visual meshes are in `appearance`. Shapes are few and plain, so that a step is fast and
a fallen robot still lies on the ground correctly.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import pi

from robot_models.parts import (
    Box,
    Capsule,
    Placed,
    Sphere,
    Vector,
    mirror_placed,
)
from robot_models.skeleton import (
    SOLE_CENTER,
    SOLE_LENGTH,
    SOLE_WIDTH,
)

FOOT_FRICTION = 0.9
"""Coefficient of friction of the feet, static and dynamic alike [-]."""

BODY_FRICTION = 0.6
"""Coefficient of friction of every other shape, static and dynamic alike [-]."""

CONTACT_RADIUS = 0.01
"""Radius of the spheres at the corners of the soles [m]."""

_ALONG_Y = (pi / 2, 0.0, 0.0)

_BACK = -0.08  # Where the chest ends and its backpack begins, along x [m].


def _sole_corners() -> tuple[Placed, ...]:
    """Returns four spheres that touch the sole plane exactly at its corners."""
    x, y, z = SOLE_CENTER
    return tuple(
        Placed(
            Sphere(CONTACT_RADIUS),
            (x + end * SOLE_LENGTH / 2, y + side * SOLE_WIDTH / 2, z + CONTACT_RADIUS),
        )
        for end in (1, -1)
        for side in (1, -1)
    )


_TRUNK: dict[str, tuple[Placed, ...]] = {
    "pelvis": (Placed(Box((0.29, 0.34, 0.22)), (0.005, 0.0, -0.005)),),
    "utorso": (
        Placed(Box((0.32, 0.38, 0.46)), (0.025, 0.0, 0.24)),
        Placed(Capsule(0.03, 0.22), (0.09, 0.0, 0.705), _ALONG_Y),
    ),
    "head": (Placed(Sphere(0.11), (-0.055, 0.0, 0.055)),),
}

_LIMBS: dict[str, tuple[Placed, ...]] = {
    "uleg": (Placed(Capsule(0.068, 0.26), (-0.02, 0.0, -0.20), (0.0, 0.17, 0.0)),),
    "lleg": (Placed(Capsule(0.05, 0.38), (0.01, 0.0, -0.21), (0.0, 0.05, 0.0)),),
    "foot": _sole_corners(),
    "clav": (Placed(Sphere(0.075), (0.0, 0.144, 0.202)),),
    "scap": (Placed(Capsule(0.055, 0.13), (0.0, 0.11, 0.01), _ALONG_Y),),
    "larm": (Placed(Capsule(0.055, 0.13), (0.0, 0.10, 0.0), _ALONG_Y),),
    "hand": (Placed(Capsule(0.05, 0.12), (0.0, 0.10, 0.005), _ALONG_Y),),
}


@dataclass(frozen=True)
class Backpack:
    """Box on the chest's back, in the frame of the upper torso [m].

    Attributes:
        depth: How far it stands out behind the chest.
        width: Its size from left to right.
        bottom: Height of its lower side.
        top: Height of its upper side.
    """

    depth: float
    width: float
    bottom: float
    top: float

    @property
    def center(self) -> Vector:
        """Center of the box."""
        return (_BACK - self.depth / 2, 0.0, (self.bottom + self.top) / 2)

    @property
    def size(self) -> Vector:
        """Edges of the box."""
        return (self.depth, self.width, self.top - self.bottom)


BACKPACKS = {
    "atlas": Backpack(depth=0.13, width=0.32, bottom=0.10, top=0.46),
    "atlas_v3": Backpack(depth=0.26, width=0.39, bottom=0.04, top=0.57),
}
"""Backpacks by robot; the heavier robot carries its batteries."""


def collisions(robot: str) -> dict[str, tuple[Placed, ...]]:
    """Returns the collision shapes of a robot by link, for both sides.

    Args:
        robot: `"atlas"` or `"atlas_v3"`; the latter carries the larger backpack.
    """
    shapes = dict(_TRUNK)
    pack = BACKPACKS[robot]
    shapes["utorso"] = (*shapes["utorso"], Placed(Box(pack.size), pack.center))
    for link, parts in _LIMBS.items():
        shapes[f"l_{link}"] = parts
        shapes[f"r_{link}"] = tuple(mirror_placed(part) for part in parts)
    return shapes


def friction(link: str) -> float:
    """Returns the coefficient of friction of a link's collision shapes [-]."""
    return FOOT_FRICTION if link in ("l_foot", "r_foot") else BODY_FRICTION


_SIDED_GROUPS: dict[str, tuple[str, ...]] = {
    "thigh": ("uglut", "lglut", "uleg"),
    "shank": ("lleg", "talus"),
    "foot": ("foot",),
    "shoulder": ("clav", "scap", "uarm"),
    "forearm": ("larm", "farm", "hand"),
}

FILTER_GROUPS: dict[str, tuple[str, ...]] = {
    "trunk": ("pelvis", "ltorso", "mtorso", "utorso", "head"),
    **{
        f"{side}_{group}": tuple(f"{side}_{link}" for link in links)
        for side in "lr"
        for group, links in _SIDED_GROUPS.items()
    },
}
"""Groups of links that collision filters speak of; every link is in one of them."""

_COLLIDING_PAIRS = (
    ("trunk", "l_forearm"),
    ("trunk", "r_forearm"),
    ("l_forearm", "r_forearm"),
    ("l_thigh", "l_forearm"),
    ("l_thigh", "r_forearm"),
    ("l_forearm", "r_thigh"),
    ("r_thigh", "r_forearm"),
    ("l_thigh", "r_thigh"),
    ("l_thigh", "r_shank"),
    ("l_shank", "r_thigh"),
    ("l_shank", "r_shank"),
    ("l_shank", "r_foot"),
    ("l_foot", "r_shank"),
    ("l_foot", "r_foot"),
)

IGNORED_PAIRS: tuple[tuple[str, str], ...] = tuple(
    pair
    for pair in combinations_with_replacement(FILTER_GROUPS, 2)
    if pair not in _COLLIDING_PAIRS
)
"""Pairs of groups whose links never collide with each other.

Neighbors in a chain overlap on purpose, and pairs that no motion of arm or leg can
bring together need no check. Every other pair of groups collides.
"""
