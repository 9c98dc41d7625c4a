"""Gives links masses and inertias that a body can have."""

from __future__ import annotations

from typing import Any

import numpy as np
import yourdfpy.urdf as urdf

from atlas_drake.clients.importing.findings import (
    GUESSED,
    LOST,
    REPAIRED,
    Findings,
    ImportRefused,
)
from atlas_drake.clients.importing.meshes import MeshLibrary
from atlas_drake.clients.importing.tree import Tree

LEAST_MASS = 1e-3
"""Mass of a moving link without one [kg]."""
LEAST_SIZE = 0.005
"""Least edge of the box about a link's shapes [m]."""
LEAST_TOTAL = 0.1
"""Mass below which a file has none [kg]."""
DENSITY = 1000.0
"""Of a link whose size is not known, as a cube [kg/m³]."""
LEAST_INERTIA = 1e-7
"""Least principal moment that is no error, per mass [m²]."""
ROUNDED, EXACT = 1e-3, 1e-6
"""Shares of the largest principal moment [-]: by the first it may exceed the sum of the
other two, which is rounding; by the second it is less after the repair."""
IMPOSSIBLE = REPAIRED, "inertia that no body has, that of its shape taken"
MISSING = REPAIRED, "inertia of zero or none, that of its shape taken"
WEIGHTLESS = LOST, "inertia of links without mass"
MASSLESS = REPAIRED, f"no mass, {1e3 * LEAST_MASS:g} g taken"
SHAPELESS = (
    GUESSED,
    f"inertia of a cube of {DENSITY:g} kg/m³, without inertia and shape",
)
"""Kinds and texts of the findings, before the names of links."""


def repair_inertias(tree: Tree, meshes: MeshLibrary, findings: Findings) -> None:
    """Gives links a mass and an inertia that a body can have.

    Raises:
        ImportRefused: If a mass is negative, or there are none.
    """
    found: dict[tuple[str, str], list[str]] = {}
    reach = float(np.ptp([X[:3, 3] for X in tree.poses().values()], axis=0).max())
    for name, link in tree.links.items():
        if link.inertial is not None:
            what = _repair(tree, link, reach, meshes)
            if what is not None:
                found.setdefault(what, []).append(name)
    total = tree.mass_of(list(tree.links))
    if not total > LEAST_TOTAL:
        raise ImportRefused(f"all links have {total:g} kg together: masses are missing")
    for joint in tree.joints.values():
        at_an_end = tree.moves(joint) and not tree.moving_below(joint.child)
        if at_an_end and tree.mass_of(tree.parts_of(joint.child)) == 0.0:
            inertia = LEAST_MASS * LEAST_SIZE**2 * np.eye(3)
            link = tree.links[joint.child]
            link.inertial = urdf.Inertial(np.eye(4), LEAST_MASS, inertia)
            found.setdefault(MASSLESS, []).append(joint.child)
    for (kind, text), names in found.items():
        findings.add_about(names, kind, text)


def _repair(
    tree: Tree, link: Any, reach: float, meshes: MeshLibrary
) -> tuple[str, str] | None:
    """Repairs the mass and the inertia of a link; returns what the fault was."""
    inertial = link.inertial
    mass, given = float(inertial.mass or 0.0), inertial.inertia
    if mass < 0.0:
        raise ImportRefused(f"link {link.name}: its mass is {mass:g} kg")
    if mass == 0.0:
        link.inertial = None
        return WEIGHTLESS
    near = _nearly_possible(mass, given, reach)
    if near is not None:
        inertial.inertia = near
        return None
    box = _box(tree, link.name, mass, inertial.origin, meshes)
    if box is None:
        size = max(np.cbrt(mass / DENSITY), LEAST_SIZE)
        inertial.inertia = mass / 6.0 * size**2 * np.eye(3)
        return SHAPELESS
    inertial.inertia = box
    return IMPOSSIBLE if given is not None and np.any(given) else MISSING


def _nearly_possible(mass: float, inertia: Any, reach: float) -> np.ndarray | None:
    """Returns a central inertia [kg·m²] that a body can have; None if it is far off.

    Principal moments keep the triangle inequality; rounding of the file is made up for.
    No link is larger than the robot, whose frames ``reach`` so far [m].
    """
    if inertia is None:
        return None
    given = np.asarray(inertia, dtype=float)
    small, middle, large = np.linalg.eigvalsh(0.5 * (given + given.T))
    beyond = large - small - middle
    if small < LEAST_INERTIA * mass or beyond > ROUNDED * large:
        return None
    if large > mass * reach**2:
        return None
    more: np.ndarray = given + max(beyond + EXACT * large, 0.0) * np.eye(3)
    return more


def _box(
    tree: Tree, name: str, mass: float, X_LC: np.ndarray, meshes: MeshLibrary
) -> np.ndarray | None:
    """Returns the inertia of the box about a link's shapes [kg·m²]; None without."""
    link = tree.links[name]
    for shapes in (link.collisions, link.visuals):
        points = meshes.vertices(shapes, np.linalg.inv(X_LC))
        if len(points):
            x, y, z = np.maximum(np.ptp(points, axis=0), LEAST_SIZE) ** 2
            inertia: np.ndarray = mass / 12.0 * np.diag([y + z, x + z, x + y])
            return inertia
    return None
