"""What of a sole is known to carry since it landed.

A sole that lands flat where its step leads carries as a whole. Else it stands on
something that nobody saw, such as a brick: then its corners that are down carry, and
the places where the center of pressure (CoP) has been. After Wiedebach, Bertrand, Wu,
Fiorio, McCrory, Griffin, Nori, Pratt, "Walking on partial footholds including line
contacts with the humanoid robot Atlas", Humanoids 2016, who explore a foothold by the
CoP as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from atlas_drake.control.gains import ContactModel
from atlas_drake.control.whole_body.terms import FrameTerms
from atlas_drake.frozen import Frozen, read_only, replace
from atlas_drake.messages.footstep import FootPose
from atlas_drake.support_polygon import convex_hull, thinned

LEVEL = 0.004
"""A corner of a sole that is farther than this from the planned ground is not down [m]:
how even ground is does not depend on the robot."""
MOST_CORNERS = 6
"""Greatest number of corners of a part that carries."""
_AROUND = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])


@dataclass(frozen=True)
class Foothold(Frozen):
    """Knowledge of one foothold.

    Attributes:
        ground: Pose of the ground at the planned landing; None for a sole that has
            stood still since nobody knows when.
        normal: Normal of the sole since it last turned, in W; None before the first
            tick with a load.
        seen: Corners of the region in which the CoP has been since then, in F [m],
            shape (k, 2).
        part: Corners of the part that carries in F [m], counterclockwise, shape
            (k, 2); None for the whole sole.
    """

    ground: FootPose | None = None
    normal: np.ndarray | None = None
    seen: np.ndarray = field(default_factory=lambda: read_only(np.empty((0, 2))))
    part: np.ndarray | None = None


WHOLE = Foothold()
"""A sole that carries as a whole."""


def ground_below(landed: FootPose, aimed: FootPose) -> FootPose:
    """Returns the pose of the planned ground at a sole that has landed."""
    normal = aimed.R_WF[:, 2]
    below = float(normal @ (aimed.p_WF - landed.p_WF))
    return FootPose(landed.p_WF + below * normal, aimed.R_WF)


def corner_heights(
    ground: FootPose, sole: FootPose | FrameTerms, corners: np.ndarray
) -> np.ndarray:
    """Computes the heights of a sole's corners over planned ground [m], shape (k,).

    ``corners`` are in F [m], shape (k, 2); heights are along the normal of the ground.
    """
    normal = ground.R_WF[:, 2]
    return corners @ (normal @ sole.R_WF)[:2] + normal @ (sole.p_WF - ground.p_WF)


def corners_down(
    ground: FootPose, sole: FootPose | FrameTerms, corners: np.ndarray
) -> np.ndarray:
    """Determines which corners of a sole are within ``LEVEL`` of planned ground.

    ``corners`` are in F [m], shape (k, 2); returns booleans, shape (k,).
    """
    return np.abs(corner_heights(ground, sole, corners)) < LEVEL


def observed(
    foothold: Foothold,
    down: np.ndarray,
    normal: np.ndarray,
    cop: np.ndarray,
    corners: np.ndarray,
    model: ContactModel,
) -> Foothold:
    """Returns what is known of a foothold on which a sole is not down as a whole.

    Args:
        foothold: What was known.
        down: Which corners are down, shape (4,).
        normal: Present normal of the sole in W, shape (3,).
        cop: Measured center of pressure in F [m], shape (2,).
        corners: Of the region of the sole in which the CoP may lie, in F [m],
            counterclockwise, shape (4, 2).
        model: Tolerances.
    """
    low, high = corners.min(axis=0), corners.max(axis=0)
    cop = np.clip(cop, low, high)
    before = foothold.normal
    if before is None or np.linalg.norm(np.cross(before, normal)) > model.turned:
        # A sole that has turned stands on other places.
        foothold = Foothold(foothold.ground, normal.copy())
    seen = thinned(convex_hull(np.vstack([foothold.seen, cop])), MOST_CORNERS)
    around = (seen[:, None] + model.explored * _AROUND).reshape(-1, 2)
    part = convex_hull(np.vstack([corners[down], np.clip(around, low, high)]))
    return replace(foothold, seen=seen, part=thinned(part, MOST_CORNERS))
