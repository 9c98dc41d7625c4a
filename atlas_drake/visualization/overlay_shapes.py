"""What overlays show: shapes in W, in the order in which to draw them.

``overlay_marks`` draws them in Meshcat, ``video_overlays`` onto pictures of a video.
Colors of links are in ``control_colors``, footsteps in ``footsteps``.
"""

from __future__ import annotations

from collections.abc import Collection
from enum import Enum, auto
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.palette import COM, COP, DCM, FORCE, SUPPORT, SWING, Color
from atlas_drake.records import TickRecord

Points = NDArray[np.float64]

BALL, PLUMB_LINE, TUBE, ARROW = 0.03, 0.003, 0.005, 0.006
"""Radii of the center of mass, of the line down to the ground, of paths and arrows
[m]."""
DISC = {"com": 0.018, "dcm": 0.022, "cop": 0.014}
"""Radii of the discs on the ground [m]."""
LIFT = {"support": 0.006, "plan": 0.010, "com": 0.012, "dcm": 0.014, "cop": 0.016}
"""Heights above the ground, all different, so that none hides another [m]."""
FORCE_SCALE = 0.0012
"""Length of an arrow per force [m/N]: the robot's weight on one corner is a metre."""
LOWEST = 0.1
"""Lower bound of the center of mass' height, for a robot that lies on the ground
[m]."""
SEEN_THROUGH = 0.5
"""Opacity of areas."""
DRAWN = frozenset({"com", "dcm", "cop", "support", "plan", "swing", "forces"})
"""The overlays that are shapes."""


class ShapeKind(Enum):
    """What the points of a shape are."""

    AREA = auto()
    """Corners of a polygon."""
    CURVE = auto()
    """Points along a curve."""
    ROD = auto()
    """Both ends of a straight line."""
    DISC = auto()
    """The center of a level disc."""
    BALL = auto()
    """The center of a ball."""
    ARROW = auto()
    """Tail and tip."""


class Shape(NamedTuple):
    """A part of an overlay.

    Attributes:
        name: Name of its own, the same at all times.
        kind: Kind of the shape.
        points: Points in W [m], shape (k, 3).
        color: Color of all of it.
        radius: Radius, or half the thickness [m]; an area has none.
    """

    name: str
    kind: ShapeKind
    points: Points
    color: Color
    radius: float = 0.0


def overlay_shapes(on: Collection[str], record: TickRecord) -> list[Shape]:
    """Computes the shapes of overlays, from the ground up.

    Args:
        on: Names of the overlays.
        record: What they show; paths and contacts as far as it has them.
    """
    ground = min(float(p_WF[2]) for p_WF in record.feet.positions)
    balance, paths = record.balance, record.paths or PlannedPaths()
    x, y, z = map(float, balance.com)
    shapes: list[Shape] = []

    def disc(name: str, place: Points, color: Color) -> None:
        center = _at(place[None, :2], ground + LIFT[name])
        shapes.append(Shape(name, ShapeKind.DISC, center, color, DISC[name]))

    if "support" in on and balance.support is not None:
        corners = _at(balance.support, ground + LIFT["support"])
        shapes.append(Shape("support", ShapeKind.AREA, corners, SUPPORT))
    if "plan" in on:
        for name, path, color in (("com", paths.com, COM), ("dcm", paths.dcm, DCM)):
            if path is not None:
                points = _at(path, ground + LIFT["plan"])
                curve = Shape(f"plan_{name}", ShapeKind.CURVE, points, color, TUBE)
                shapes.append(curve)
    if "swing" in on and paths.swing is not None:
        shapes.append(Shape("swing", ShapeKind.CURVE, paths.swing, SWING, TUBE))
    if "com" in on:
        top = max(z, ground + LOWEST)
        line = np.array([[x, y, ground], [x, y, top]])
        shapes.append(Shape("com_line", ShapeKind.ROD, line, COM, PLUMB_LINE))
        disc("com", balance.com, COM)
        ball = np.array([[x, y, z]])
        shapes.append(Shape("com_ball", ShapeKind.BALL, ball, COM, BALL))
    if "dcm" in on:
        disc("dcm", balance.dcm, DCM)
    if "cop" in on and balance.cop is not None:
        disc("cop", balance.cop, COP)
    if "forces" in on:
        for number, force in enumerate(record.contacts or ()):
            ends = np.array([force.p_WC, force.p_WC + FORCE_SCALE * force.force_W])
            name = f"forces/{number}"
            shapes.append(Shape(name, ShapeKind.ARROW, ends, FORCE, ARROW))
    return shapes


def _at(flat: Points, height: float) -> Points:
    """Adds a height [m] to points in the plane, shape (k, 2)."""
    return np.column_stack([flat, np.full(len(flat), height)])
