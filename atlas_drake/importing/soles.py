"""Where the soles are: the lowest part of each foot's shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from atlas_drake.importing.anatomy import Anatomy
from atlas_drake.importing.findings import FOUND, GUESSED, Findings, ImportRefused
from atlas_drake.importing.meshes import MeshLibrary
from atlas_drake.importing.options import ImportOptions
from atlas_drake.importing.tree import Tree

DEPTH = 0.03
"""Height above the lowest point up to which a foot is sole, in its lengths [-]."""
LEAST_LENGTH, LEAST_WIDTH = 0.03, 0.015
"""Least size of a sole [m]; a point foot has none."""
FILLED, LEAST_SHARE = 0.9, 0.3
"""Share of its rectangle below which a sole is round, and below which it is none
[-]."""


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
    found, filled = [], 1.0
    for foot in anatomy.feet:
        points, kind = _points(tree, foot, X, meshes)
        if not len(points):
            lost = "".join(f" ({why})" for why in list(meshes.lost.values())[:1])
            told = "--sole LENGTH WIDTH HEIGHT_OF_ANKLE AHEAD"
            raise ImportRefused(
                f"link {foot}: has no shape that tells where its sole is{lost}; say "
                f"so: {told}"
            )
        length = float(np.ptp(points[:, 0]))
        low = points[points[:, 2] < points[:, 2].min() + DEPTH * length]
        least, most = low.min(axis=0), low.max(axis=0)
        size = most - least
        share = _area(low[:, :2]) / max(size[0] * size[1], 1e-9)
        if size[0] < LEAST_LENGTH or size[1] < LEAST_WIDTH or share < LEAST_SHARE:
            raise ImportRefused(
                f"link {foot}: its sole would be {size[0]:.3f} m long and "
                f"{size[1]:.3f} m wide, a point; say otherwise: --sole, or make the "
                "root's frame level"
            )
        found.append((foot, least, most, kind))
        filled = min(filled, share)
    length, width = (
        min(float(most[axis] - least[axis]) for _, least, most, _ in found)
        for axis in (0, 1)
    )
    poses = [
        _upright(X[foot], [*(0.5 * (least + most))[:2], least[2]])
        for foot, least, most, _ in found
    ]
    kind = found[0][-1]
    text = f"soles {length:.3f} m long and {width:.3f} m wide, from the {kind} shapes"
    if filled < FILLED:
        text += f", which fill {filled:.0%} of these rectangles"
    findings.add(FOUND if kind == "collision" and filled >= FILLED else GUESSED, text)
    return Soles(length, width, (poses[0], poses[1]))


def _points(
    tree: Tree, foot: str, X: dict[str, np.ndarray], meshes: MeshLibrary
) -> tuple[np.ndarray, str]:
    """Returns the vertices of a foot's shapes in the root's frame, and their kind.

    A ball touches the ground at its lowest point.
    """
    for kind in ("collision", "visual"):
        points = [np.zeros((0, 3))]
        for part in tree.all_below(foot):
            for shape in getattr(tree.links[part], f"{kind}s"):
                ball = shape.geometry.sphere
                if ball is None:
                    points.append(meshes.vertices([shape], X[part]))
                else:
                    middle = (X[part] @ shape.origin)[:3, 3]
                    points.append(middle[None] - [0.0, 0.0, ball.radius])
        found = np.concatenate(points)
        if len(found):
            return found, kind
    return np.zeros((0, 3)), ""


def _area(points: np.ndarray) -> float:
    """Returns the area of the convex hull of points in a plane [m²]."""
    try:
        return float(ConvexHull(points).volume)
    except QhullError:  # All on one line.
        return 0.0


def _upright(X_PL: np.ndarray, place: np.ndarray | list[float]) -> np.ndarray:
    """Returns the frame at a place, parallel to the pelvis, in the link's frame."""
    X_PS = np.eye(4)
    X_PS[:3, 3] = place
    inverse: np.ndarray = np.linalg.inv(X_PL) @ X_PS
    return inverse
