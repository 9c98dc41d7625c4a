"""Figures about balance: CoM, DCM and CoP against the support, feet and pelvis.

Panels as data; ``figures`` arranges them on the page. Contact and poses of the soles
over time are computed from the log.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.sole import sole_corners
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.logs.log import Log
from atlas_drake.logs.panels import JOINT_COLORS, Band, Item, Line, Outline, Panel
from atlas_drake.palette import COM, COP, DCM, FEET, hex_color
from atlas_drake.rotations import rotation_z

SIDES = ("left", "right")
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


SIDE_COLORS = tuple(map(hex_color, FEET))
_AREA = "#cfd8dc"
"""Pale, as the supports of many steps overlap."""
_TRACKS = (
    ("com_reference", hex_color(COM), "", True),
    ("com", hex_color(COM), "CoM", False),
    ("dcm_reference", hex_color(DCM), "", True),
    ("dcm", hex_color(DCM), "DCM", False),
    ("cop_reference", hex_color(COP), "", True),
    ("cop", hex_color(COP), "CoP", False),
)
"""Channel below ``balance``, color, label, and whether it is a plan: dashed."""


def view_from_above(log: Log, feet: Feet) -> Panel:
    """Draw CoM, DCM and CoP over the footprints and support polygons."""
    items: list[Item] = [
        Outline(polygon, _AREA, opacity=0.35) for polygon in double_supports(log, feet)
    ]
    for foot, side in enumerate(SIDES):
        color = SIDE_COLORS[foot]
        for number, corners in enumerate(footprints(log, feet, foot)):
            label = f"{side} foot" if number == 0 else ""
            items.append(Outline(corners, color, label, opacity=0.18))
    items += [
        Outline(_sole(log, event.data["commanded"]), "#555555", dashed=True)
        for event in log.events
        if event.kind == "footstep"
    ]
    for name, track, color, label, dashed in _tracks(log):
        width = 0.6 if name.startswith("cop") else 1.3
        items.append(Line(track[:, 0], track[:, 1], color, label, dashed, width))
    return Panel(
        "From above (dashed: planned)",
        "y, to the left [m]",
        tuple(items),
        x_label="x, ahead [m]",
        over_time=False,
        equal=True,
        rows=2,
    )


def balance_over_time(log: Log, feet: Feet, axis: int) -> Panel:
    """CoM, DCM and CoP along x (axis 0) or y (1) against the extent of the support."""
    items: list[Item] = [Band(log.time, *feet.extent(axis), _AREA, "support")]
    items += [
        Line(log.time, track[:, axis], color, label, dashed)
        for _, track, color, label, dashed in _tracks(log)
    ]
    where = "ahead" if axis == 0 else "sideways"
    title = f"Balance {where} (dashed: planned)"
    return Panel(title, f"{'xy'[axis]} [m]", tuple(items))


def _tracks(log: Log) -> Iterator[tuple[str, np.ndarray, str, str, bool]]:
    """What there is of the tracks; a controller need not plan every one of them."""
    for name, color, label, dashed in _TRACKS:
        track = log[f"balance.{name}"]
        if not dashed or np.isfinite(track).any():
            yield name, track, color, label, dashed


def _sole(log: Log, pose: list[float]) -> np.ndarray:
    """Corners of a sole at x, y [m] and yaw [rad], shape (4, 2)."""
    x, y, yaw = pose
    size = log.robot.file.sole
    corners = sole_corners(
        np.array([x, y, 0.0]), rotation_z(yaw), 0.5 * size.length, 0.5 * size.width
    )
    return corners[:, :2]


# ---- feet and pelvis ---------------------------------------------------------


def foot_heights(log: Log) -> Panel:
    """Heights of both soles."""
    return _vertical(log, "position", "Foot heights", "sole z [m]")


def foot_forces(log: Log) -> Panel:
    """Vertical forces on both soles."""
    return _vertical(log, "force", "Foot forces", "vertical [N]")


def _vertical(log: Log, name: str, title: str, y_label: str) -> Panel:
    """Draws the z of a channel of both feet."""
    items = tuple(
        Line(log.time, log[f"feet.{side}_{name}"][:, 2], color, side)
        for side, color in zip(SIDES, SIDE_COLORS, strict=True)
    )
    return Panel(title, y_label, items)


def pelvis_angles(log: Log) -> Panel:
    """Orientation of the pelvis."""
    angles = np.array(
        [RollPitchYaw(R_WB).vector() for R_WB in rotations(log["pelvis.orientation"])]
    )
    names = ("roll", "pitch", "yaw")
    items = tuple(
        Line(log.time, angles[:, axis], color, name)
        for axis, (name, color) in enumerate(zip(names, JOINT_COLORS, strict=False))
    )
    return Panel("Orientation of the pelvis", "angle [rad]", items)


def pelvis_velocity(log: Log) -> Panel:
    """Velocity of the pelvis."""
    velocity = log["pelvis.velocity"]
    items = tuple(
        Line(log.time, velocity[:, axis], color, name)
        for axis, (name, color) in enumerate(zip("xyz", JOINT_COLORS, strict=False))
    )
    return Panel("Velocity of the pelvis in the world", "velocity [m/s]", items)
