"""Where the soles are: the lowest part of each foot's shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from atlas_drake.clients.importing.anatomy import Anatomy
from atlas_drake.clients.importing.findings import (
    FOUND,
    GUESSED,
    Findings,
    ImportRefused,
)
from atlas_drake.clients.importing.meshes import MeshLibrary
from atlas_drake.clients.importing.options import ImportOptions
from atlas_drake.clients.importing.tree import Tree

DEPTH = 0.03
"""The sole is what lies at most so high above a foot's lowest point, in lengths of the
foot [-]."""
LEAST_LENGTH, LEAST_WIDTH = 0.03, 0.015
"""Least size of a sole [m]; a point foot has none."""
FILLED, LEAST_SHARE = 0.9, 0.3
"""A sole that fills less of its rectangle than the first share is round; one that fills
less than the second is none [-]."""


@dataclass(frozen=True)
class Soles:
    """The soles' rectangles.

    Attributes:
        length: Along x [m].
        width: Along y [m].
        poses: Pose of the sole's frame in each foot's link, shape (4, 4).
    """

    length: float
    width: float
    poses: tuple[np.ndarray, np.ndarray]


def find_soles(
    tree: Tree,
    anatomy: Anatomy,
    meshes: MeshLibrary,
    options: ImportOptions,
    findings: Findings,
) -> Soles:
    """Finds the soles with all joints at zero, of a robot that faces along x."""
    X = tree.poses()
    if options.sole is not None:
        length, width, above, ahead = options.sole
        possible = min(length, width) > 0.0 and above >= 0.0
        if not (possible and all(map(math.isfinite, options.sole))):
            given = " ".join(f"{one:g}" for one in options.sole)
            raise ImportRefused(
                f"--sole {given}: must be numbers, length and width above 0, height "
                "not below"
            )
        place = np.array([ahead, 0.0, -above])
        poses = [_upright(X[foot], X[foot][:3, 3] + place) for foot in anatomy.feet]
        return Soles(length, width, (poses[0], poses[1]))
    found = [_sole(tree, foot, X, meshes) for foot in anatomy.feet]
    length, width = (min(float(sole.size[axis]) for sole in found) for axis in (0, 1))
    poses = [
        _upright(X[foot], [*(0.5 * (sole.least + sole.most))[:2], sole.least[2]])
        for foot, sole in zip(anatomy.feet, found, strict=True)
    ]
    kind = "collision" if all(sole.kind == "collision" for sole in found) else "visual"
    filled = min(sole.share for sole in found)
    text = f"soles {length:.3f} m long and {width:.3f} m wide, from the {kind} shapes"
    if filled < FILLED:
        text += f", which fill {filled:.0%} of these rectangles"
    findings.add(FOUND if kind == "collision" and filled >= FILLED else GUESSED, text)
    return Soles(length, width, (poses[0], poses[1]))


@dataclass(frozen=True)
class _Sole:
    """The lowest part of a foot's shapes of one kind, in the root's frame."""

    kind: str
    least: np.ndarray
    most: np.ndarray
    share: float
    """Share of its rectangle that it fills [-]."""

    @property
    def size(self) -> np.ndarray:
        """Length and width [m]."""
        return (self.most - self.least)[:2]

    @property
    def is_one(self) -> bool:
        """False for a point or a line, as of shapes that are not all there."""
        length, width = self.size
        long, wide = length >= LEAST_LENGTH, width >= LEAST_WIDTH
        return bool(long and wide and self.share >= LEAST_SHARE)


def _sole(
    tree: Tree, foot: str, X: dict[str, np.ndarray], meshes: MeshLibrary
) -> _Sole:
    """Finds the sole of a foot by its collision shapes, or else its visible ones."""
    seen = [
        _lowest(kind, points)
        for kind in ("collision", "visual")
        if len(points := _points(tree, foot, kind, X, meshes))
    ]
    for sole in seen:
        if sole.is_one:
            return sole
    lost = "".join(f" ({why})" for why in list(meshes.lost.values())[:1])
    if not seen:
        raise ImportRefused(
            f"link {foot}: has no shape that tells where its sole is{lost}; say so: "
            "--sole LENGTH WIDTH HEIGHT_OF_ANKLE AHEAD"
        )
    length, width = seen[0].size
    raise ImportRefused(
        f"link {foot}: its sole would be {length:.3f} m long and {width:.3f} m wide, a "
        f"point{lost}; say otherwise: --sole, or make the root's frame level"
    )


def _lowest(kind: str, points: np.ndarray) -> _Sole:
    height = points[:, 2].min() + DEPTH * float(np.ptp(points[:, 0]))
    low = points[points[:, 2] <= height]
    least, most = low.min(axis=0), low.max(axis=0)
    share = _area(low[:, :2]) / max(float(np.prod((most - least)[:2])), 1e-9)
    return _Sole(kind, least, most, share)


def _points(
    tree: Tree, foot: str, kind: str, X: dict[str, np.ndarray], meshes: MeshLibrary
) -> np.ndarray:
    """Returns the vertices of a foot's shapes of a kind in the root's frame.

    A ball touches the ground at its lowest point.
    """
    points = [np.zeros((0, 3))]
    for part in tree.all_below(foot):
        for shape in getattr(tree.links[part], f"{kind}s"):
            if shape.geometry.kind == "sphere":
                middle = (X[part] @ shape.origin)[:3, 3]
                radius = shape.geometry.size("radius")
                points.append(middle[None] - [0.0, 0.0, radius])
            else:
                points.append(meshes.vertices([shape], X[part]))
    return np.concatenate(points)


def _area(points: np.ndarray) -> float:
    """Returns the area of the convex hull of points in a plane [m²]."""
    try:
        return float(ConvexHull(points).volume)
    except QhullError:  # All on one line.
        return 0.0


def _upright(X_PL: np.ndarray, place: np.ndarray | list[float]) -> np.ndarray:
    """Returns the pose of a sole S in its link L, shape (4, 4).

    The sole is parallel to the pelvis P, and at a ``place`` in it [m].
    """
    X_PS = np.eye(4)
    X_PS[:3, 3] = place
    inverse: np.ndarray = np.linalg.inv(X_PL) @ X_PS
    return inverse
