"""Where the soles are: the lowest part of each foot's shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.importing.anatomy import Anatomy
from atlas_drake.importing.findings import FOUND, GUESSED, Findings, ImportRefused
from atlas_drake.importing.meshes import MeshLibrary
from atlas_drake.importing.options import ImportOptions
from atlas_drake.importing.tree import Tree

DEPTH = 0.03
"""Height above the lowest point up to which a foot is sole, in its lengths [-]."""
LEAST_LENGTH, LEAST_WIDTH = 0.03, 0.015
"""Least size of a sole [m]; a point foot has none."""


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
        if not all(map(math.isfinite, options.sole)) or min(length, width) <= 0.0:
            given = " ".join(f"{one:g}" for one in options.sole)
            raise ImportRefused(
                f"--sole {given}: must be numbers, length and width above 0"
            )
        place = np.array([ahead, 0.0, -above])
        poses = [_upright(X[foot], X[foot][:3, 3] + place) for foot in anatomy.feet]
        return Soles(length, width, (poses[0], poses[1]))
    found = []
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
        if size[0] < LEAST_LENGTH or size[1] < LEAST_WIDTH:
            raise ImportRefused(
                f"link {foot}: its sole would be {size[0]:.3f} m long and "
                f"{size[1]:.3f} m wide, a point; say otherwise: --sole"
            )
        found.append((foot, least, most, kind))
    length, width = (
        min(float(most[axis] - least[axis]) for _, least, most, _ in found)
        for axis in (0, 1)
    )
    poses = [
        _upright(X[foot], [*(0.5 * (least + most))[:2], least[2]])
        for foot, least, most, _ in found
    ]
    kind = found[0][-1]
    findings.add(
        FOUND if kind == "collision" else GUESSED,
        f"soles {length:.3f} m long and {width:.3f} m wide, from the {kind} shapes",
    )
    return Soles(length, width, (poses[0], poses[1]))


def _points(
    tree: Tree, foot: str, X: dict[str, np.ndarray], meshes: MeshLibrary
) -> tuple[np.ndarray, str]:
    """Returns the vertices of a foot's shapes in the root's frame, and their kind."""
    for kind in ("collision", "visual"):
        points = np.concatenate(
            [
                meshes.vertices(getattr(tree.links[part], f"{kind}s"), X[part])
                for part in tree.all_below(foot)
            ]
        )
        if len(points):
            return points, kind
    return np.zeros((0, 3)), ""


def _upright(X_PL: np.ndarray, place: np.ndarray | list[float]) -> np.ndarray:
    """Returns the frame at a place, parallel to the pelvis, in the link's frame."""
    X_PS = np.eye(4)
    X_PS[:3, 3] = place
    inverse: np.ndarray = np.linalg.inv(X_PL) @ X_PS
    return inverse
