"""The footsteps on the ground: as commanded, as they will be taken, as they landed.

All poses are poses of the sole frame, drawn level at the height of the ground.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, Rgba
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.behaviors.footsteps import footstep_from
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData
from atlas_drake.palette import FEET
from atlas_drake.records import TickRecord
from atlas_drake.robot import SoleSize
from atlas_drake.visualization.shapes import draw_flat, ribbons

LANDED_OPACITY = 0.45
VISIBLE_SHIFT, VISIBLE_TURN = 0.01, 0.03
"""Changes of a step below this [m] or [rad] are shown as commanded."""
HEIGHT_GRID = 0.002
"""Resolution of heights [m], so that a stance foot's small motion makes no new mark."""
LINE_WIDTH = 0.008
"""Width of the outlines [m]."""
CORNER_POINTS = 7
"""Points of each rounded corner."""
TOE_ROUNDING, HEEL_ROUNDING = 1.0, 0.55
"""Radius of the corners in half widths of the sole: rounder toes show the heading."""


class Kind(Enum):
    """Kind of a footstep mark; the value is its height above the ground [m]."""

    LANDED = 0.003
    COMMANDED = 0.004
    SATURATED = 0.005


@dataclass(frozen=True)
class FootstepMark:
    """One sole on the ground; position in W [m], heading [rad], height in W [m]."""

    kind: Kind
    foot: int
    x: float
    y: float
    yaw: float
    z: float = 0.0

    @property
    def X_WF(self) -> RigidTransform:
        """Pose of the mark."""
        p_WF: Any = np.array([self.x, self.y, self.z + self.kind.value])
        return RigidTransform(RotationMatrix.MakeZRotation(self.yaw), p_WF)


def footstep_marks(record: TickRecord) -> list[FootstepMark]:
    """Collects the marks of footsteps: commanded, as they will be taken, landed.

    The footsteps of the plan are used where the feedback of WALK or STEP lacks them.
    """
    marks = []
    for event in record.landed:
        foot = event.data["foot"]
        commanded, saturated = event.data["commanded"], event.data["saturated"]
        z = event.data["landed_height"]
        marks.append(_mark(Kind.LANDED, foot, event.data["landed"], z))
        marks.append(_mark(Kind.COMMANDED, foot, commanded, z))
        if _differ(commanded, saturated):
            marks.append(_mark(Kind.SATURATED, foot, saturated, z))
    walk, step = record.walk, record.step
    if step.is_active:
        if step.t_step_rem > 0.0:
            z = step.desired_step_saturated.pose.position.z
            for foot, pose in _poses([step.desired_step_saturated]).values():
                marks.append(_mark(Kind.COMMANDED, foot, pose, z))
        return marks
    if not walk.is_active:
        for planned in record.footsteps:
            x, y, z = map(float, planned.p_WF)
            place = _steady([x, y, planned.yaw])
            marks.append(_mark(Kind.COMMANDED, planned.foot, place, z))
        return marks
    first = max(walk.current_step_index, 1)
    queue = walk.step_queue_saturated
    taken = _poses(queue)
    # The report of the step to be taken defines the commanded height.
    heights = {data.step_index: data.pose.position.z for data in queue}
    coming = {}
    request = record.request
    # A request that is not the active behavior's has no step queue.
    if request is not None and not request.walk_params.use_demo_walk:
        for index, (foot, pose) in _poses(request.walk_params.step_queue).items():
            if index >= first:
                coming[index] = pose
                z = heights.get(index, 0.0)
                marks.append(_mark(Kind.COMMANDED, foot, pose, z))
    for index, (foot, pose) in taken.items():
        # Steps of an earlier message are in the report only.
        known = index in coming
        if index < first or (known and not _differ(coming[index], pose)):
            continue
        kind = Kind.SATURATED if known else Kind.COMMANDED
        marks.append(_mark(kind, foot, _steady(pose), heights[index]))
    return marks


def _poses(
    queue: Iterable[AtlasBehaviorStepData],
) -> dict[int, tuple[int, list[float]]]:
    """Foot and pose (x, y, yaw) of each step in a queue, by index."""
    steps = [footstep_from(data) for data in queue if data.step_index != NO_STEP]
    return {s.index: (s.foot, [*map(float, s.p_WF[:2]), s.yaw]) for s in steps}


def _steady(pose: Sequence[float]) -> list[float]:
    """Rounds x, y and yaw.

    Balance moves a step a little all the time; small moves make no new mark.
    """
    grid = (VISIBLE_SHIFT, VISIBLE_SHIFT, VISIBLE_TURN)
    return [g * round(value / g) for value, g in zip(pose, grid, strict=True)]


def _mark(kind: Kind, foot: int, pose: Sequence[float], z: float) -> FootstepMark:
    # Rounded, so that a step looks the same before and after it is taken.
    x, y, yaw = (round(float(value), 4) for value in pose)
    height = round(HEIGHT_GRID * round(z / HEIGHT_GRID), 4)
    return FootstepMark(kind, foot, x, y, yaw, height)


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    shift = float(np.hypot(a[0] - b[0], a[1] - b[1]))
    return shift > VISIBLE_SHIFT or abs(a[2] - b[2]) > VISIBLE_TURN


def sole_outline(sole: SoleSize) -> NDArray[np.float64]:
    """Computes the outline of a sole, rounder at the toes.

    Returns:
        Points in the sole frame, counter-clockwise and not closed [m], shape
        (3, number of points); z is zero.
    """
    half = np.array([0.5 * sole.length, 0.5 * sole.width])
    points = []
    corners = [(1, 1, 0.0), (-1, 1, 0.5), (-1, -1, 1.0), (1, -1, 1.5)]
    for sign_x, sign_y, begin in corners:
        radius = half[1] * (TOE_ROUNDING if sign_x > 0 else HEEL_ROUNDING)
        center = np.array([sign_x, sign_y]) * (half - radius)
        for angle in np.pi * np.linspace(begin, begin + 0.5, CORNER_POINTS):
            points.append(center + radius * np.array([np.cos(angle), np.sin(angle)]))
    outline = np.zeros((3, len(points)), order="F")
    outline[:2] = np.array(points).T
    return outline


def mark_triangles(
    kind: Kind, outline: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Computes the shape of a mark: filled, an outline, or dashes.

    Returns:
        Vertices in the sole frame [m], shape (3, any), and triangles, shape (3, any).
    """
    if kind is Kind.LANDED:
        last = outline.shape[1] - 1
        fan = [[0, i, i + 1] for i in range(1, last)]
        return outline, np.array(fan, dtype=np.int32).T
    every = slice(None, None, 2 if kind is Kind.SATURATED else 1)
    starts = outline[:, every]
    ends = np.roll(outline, -1, axis=1)[:, every]
    return ribbons(starts, ends, LINE_WIDTH)


def draw_footstep(
    meshcat: Meshcat, outline: NDArray[np.float64], path: str, mark: object
) -> None:
    """Draws a ``FootstepMark`` in Meshcat.

    An outline shows a commanded step, a dashed one a step that is not taken as
    commanded, and a filled one a step that has landed.

    Args:
        meshcat: Meshcat instance to draw in.
        outline: Outline of the sole, see ``sole_outline``.
        path: Path of the object.
        mark: The mark.
    """
    assert isinstance(mark, FootstepMark)
    opacity = LANDED_OPACITY if mark.kind is Kind.LANDED else 1.0
    color = Rgba(*FEET[mark.foot], opacity)
    draw_flat(meshcat, path, *mark_triangles(mark.kind, outline), color)
    meshcat.SetTransform(path, mark.X_WF)
