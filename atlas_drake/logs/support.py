"""The feet on the ground over time, for figures: contact and poses of the soles.

Computed from a log; plane geometry only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RotationMatrix

from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.sole import sole_corners
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log

CONTACT_SHARE = 0.04
"""Least share of the robot's weight on a sole that counts as contact [-]."""
SHORTEST_STANCE = 0.06
"""Shorter contacts are not drawn [s]."""
SAME_PLACE = 0.01
"""Footprints closer together than this are drawn once [m]."""


@dataclass(frozen=True)
class Feet:
    """Both soles over time.

    Attributes:
        corners: Corners in W, horizontal [m], shape (2, rows, 4, 2).
        contact: True for soles that carry load, bool, shape (2, rows).
    """

    corners: np.ndarray
    contact: np.ndarray

    def extent(self, axis: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinate of the soles in contact [m], shape (rows,)."""
        corners = self.corners[..., axis]
        loaded, held = self.contact[:, :, None], self.contact.any(axis=0)
        low = np.where(loaded, corners, np.inf).min(axis=(0, 2))
        high = np.where(loaded, corners, -np.inf).max(axis=(0, 2))
        return np.where(held, low, np.nan), np.where(held, high, np.nan)


def feet_of(log: Log) -> Feet:
    """Computes the feet over time from a log."""
    sole = log.robot.file.sole
    load = CONTACT_SHARE * log.robot.mass * GRAVITY
    corners, contact = [], []
    half = 0.5 * sole.length, 0.5 * sole.width
    for side in SIDES:
        poses = zip(
            log[f"feet.{side}_position"],
            rotations(log[f"feet.{side}_orientation"]),
            strict=True,
        )
        corners.append(
            [sole_corners(p_WF, R_WF.matrix(), *half)[:, :2] for p_WF, R_WF in poses]
        )
        contact.append(log[f"feet.{side}_force"][:, 2] > load)
    return Feet(np.array(corners), np.array(contact))


def rotations(orientations: np.ndarray) -> Iterator[RotationMatrix]:
    """Converts quaternions, w first, shape (rows, 4); their length is of no account."""
    for wxyz in orientations:
        yield RotationMatrix(Quaternion(wxyz / np.linalg.norm(wxyz)))


def runs(flags: np.ndarray) -> Iterator[tuple[int, int]]:
    """Finds starts and ends, exclusive, of the intervals in which flags are set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def footprints(log: Log, feet: Feet, foot: int) -> list[np.ndarray]:
    """Finds the footprints of one sole: corners in W [m], each of shape (4, 2)."""
    prints: list[np.ndarray] = []
    for begin, end in runs(feet.contact[foot]):
        if log.time[end - 1] - log.time[begin] >= SHORTEST_STANCE:
            _append_new(prints, feet.corners[foot, (begin + end) // 2])
    return prints


def double_supports(log: Log, feet: Feet) -> list[np.ndarray]:
    """Finds the support polygons of both soles: corners in W [m], shape (any, 2)."""
    pairs: list[np.ndarray] = []
    for begin, end in runs(np.logical_and(*feet.contact)):
        if log.time[end - 1] - log.time[begin] >= SHORTEST_STANCE:
            _append_new(pairs, feet.corners[:, (begin + end) // 2].reshape(8, 2))
    return [SupportPolygon(pair).vertices for pair in pairs]


def _append_new(known: list[np.ndarray], fresh: np.ndarray) -> None:
    if not any(np.abs(fresh - old).max() < SAME_PLACE for old in known):
        known.append(fresh)
