"""Both soles over time, computed from a log: where they were, and when in contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from atlas_drake.clients.logs.log import Log
from atlas_drake.robot.soles import sole_corners
from atlas_drake.rotations import rotation_matrix, rotation_z
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import GRAVITY

SIDES = ("left", "right")
CONTACT_SHARE = 0.04
"""Smallest share of the robot's weight on a sole that counts as contact [-]."""
MIN_STANCE = 0.06
"""Shorter contacts leave no footprint [s]."""
SAME_PLACE = 0.01
"""Footprints closer together than this are one [m]."""


@dataclass(frozen=True)
class Soles:
    """Both soles over time."""

    time: np.ndarray  # [s], shape (rows,).
    corners: np.ndarray  # In W, horizontal [m], shape (2, rows, 4, 2).
    contact: np.ndarray  # True for soles that carry load, shape (2, rows).

    def extent(self, axis: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinate of the soles in contact [m], shape (rows,)."""
        corners = self.corners[..., axis]
        loaded, held = self.contact[:, :, None], self.contact.any(axis=0)
        low = np.where(loaded, corners, np.inf).min(axis=(0, 2))
        high = np.where(loaded, corners, -np.inf).max(axis=(0, 2))
        return np.where(held, low, np.nan), np.where(held, high, np.nan)

    def footprints(self, foot: int) -> list[np.ndarray]:
        """Footprints of one sole: corners in W [m], each of shape (4, 2)."""
        return self._stances(self.contact[foot], self.corners[foot])

    def double_supports(self) -> list[np.ndarray]:
        """Support polygons of both soles: corners in W [m], each of shape (any, 2)."""
        pairs = self.corners.swapaxes(0, 1).reshape(-1, 8, 2)
        stances = self._stances(np.logical_and(*self.contact), pairs)
        return [SupportPolygon(pair).vertices for pair in stances]

    def _stances(self, contact: np.ndarray, corners: np.ndarray) -> list[np.ndarray]:
        """Returns the corners in the middle of each contact, those of a place once."""
        found: list[np.ndarray] = []
        for begin, end in runs(contact):
            middle = corners[(begin + end) // 2]
            if self.time[end - 1] - self.time[begin] >= MIN_STANCE and not any(
                np.abs(middle - known).max() < SAME_PLACE for known in found
            ):
                found.append(middle)
        return found


def soles_of(log: Log) -> Soles:
    """Computes the soles over time."""
    load = CONTACT_SHARE * log.robot.mass * GRAVITY
    half = _half_size(log)
    corners = [
        [
            sole_corners(p_WF, rotation_matrix(q_WF), *half)[:, :2]
            for p_WF, q_WF in zip(
                log[f"feet.{side}_position"],
                log[f"feet.{side}_orientation"],
                strict=True,
            )
        ]
        for side in SIDES
    ]
    contact = [log[f"feet.{side}_force.z"] > load for side in SIDES]
    return Soles(log.time, np.array(corners), np.array(contact))


def commanded_footprints(log: Log) -> Iterator[np.ndarray]:
    """Yields the corners in W [m] of the steps that were commanded, shape (4, 2)."""
    for event in log.events:
        if event.kind == "footstep":
            x, y, yaw = event.data["commanded"]
            center = np.array([x, y, 0.0])
            yield sole_corners(center, rotation_z(yaw), *_half_size(log))[:, :2]


def _half_size(log: Log) -> tuple[float, float]:
    sole = log.robot.file.sole
    return 0.5 * sole.length, 0.5 * sole.width


def runs(flags: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yields starts and ends, exclusive, of the intervals in which flags are set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
