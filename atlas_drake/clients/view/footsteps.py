"""The footsteps on the ground: as commanded, as they will be taken, as they landed.

All poses are poses of the sole frame, drawn level at the height of the ground.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.clients.view.solids import (
    Points,
    Solid,
    Triangles,
    polygon,
    ribbons,
)
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData
from atlas_drake.messages.footstep import footstep_from
from atlas_drake.palette import FEET
from atlas_drake.records import TickRecord
from atlas_drake.robot import SoleSize

LANDED, COMMANDED, SATURATED = "landed", "commanded", "saturated"
MARK_LIFT = {LANDED: 0.003, COMMANDED: 0.004, SATURATED: 0.005}
"""Kinds of footstep marks, and their heights above the ground [m]."""
LANDED_OPACITY = 0.45
VISIBLE_SHIFT, VISIBLE_TURN = 0.01, 0.03
"""Changes of a step below this [m] or [rad] are shown as commanded."""
HEIGHT_GRID = 0.002
"""Resolution of heights [m], so that a stance foot's small motion makes no new mark."""
LINE_WIDTH = 0.012
"""Width of the outlines [m]."""
CORNER_POINTS = 7
"""Points of each rounded corner."""
TOE_ROUNDING, HEEL_ROUNDING = 1.0, 0.55
"""Radius of the corners in half widths of the sole: rounder toes show the heading."""


class FootstepMark(NamedTuple):
    """A sole on level ground: position in W [m], heading [rad], height in W [m]."""

    kind: str
    foot: int
    x: float
    y: float
    yaw: float
    z: float = 0.0

    @property
    def X_WF(self) -> RigidTransform:
        """Pose of the mark."""
        p_WF = [self.x, self.y, self.z + MARK_LIFT[self.kind]]
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
        marks.append(_mark(LANDED, foot, event.data["landed"], z))
        marks.append(_mark(COMMANDED, foot, commanded, z))
        if _differ(commanded, saturated):
            marks.append(_mark(SATURATED, foot, saturated, z))
    walk, step = record.walk, record.step
    if step.is_active:
        if step.t_step_rem > 0.0:
            z = step.desired_step_saturated.pose.position.z
            for foot, pose in _poses([step.desired_step_saturated]).values():
                marks.append(_mark(COMMANDED, foot, pose, z))
        return marks
    if not walk.is_active:
        for planned in record.footsteps:
            x, y, z = map(float, planned.p_WF)
            place = _steady([x, y, planned.yaw])
            marks.append(_mark(COMMANDED, planned.foot, place, z))
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
                marks.append(_mark(COMMANDED, foot, pose, z))
    for index, (foot, pose) in taken.items():
        # Steps of an earlier message are in the report only.
        known = index in coming
        if index < first or (known and not _differ(coming[index], pose)):
            continue
        kind = SATURATED if known else COMMANDED
        marks.append(_mark(kind, foot, _steady(pose), heights[index]))
    return marks


def _poses(
    queue: Iterable[AtlasBehaviorStepData],
) -> dict[int, tuple[int, list[float]]]:
    """Foot and pose (x, y, yaw) of each step in a queue, by index."""
    steps = [footstep_from(data) for data in queue if data.step_index != NO_STEP]
    return {s.index: (s.foot, [*map(float, s.p_WF[:2]), s.yaw]) for s in steps}


def _steady(pose: Sequence[float]) -> list[float]:
    """Rounds x, y and yaw: balance moves a step a little all the time."""
    grid = (VISIBLE_SHIFT, VISIBLE_SHIFT, VISIBLE_TURN)
    return [g * round(value / g) for value, g in zip(pose, grid, strict=True)]


def _mark(kind: str, foot: int, pose: Sequence[float], z: float) -> FootstepMark:
    # Rounded, so that a step looks the same before and after it is taken.
    x, y, yaw = (round(float(value), 4) for value in pose)
    height = round(HEIGHT_GRID * round(z / HEIGHT_GRID), 4)
    return FootstepMark(kind, foot, x, y, yaw, height)


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    shift = float(np.hypot(a[0] - b[0], a[1] - b[1]))
    return shift > VISIBLE_SHIFT or abs(a[2] - b[2]) > VISIBLE_TURN


def mark_solid(mark: FootstepMark, sole: SoleSize) -> Solid:
    """Makes the solid of a mark, with vertices in W."""
    vertices, faces = mark_triangles(mark.kind, sole)
    opacity = LANDED_OPACITY if mark.kind == LANDED else 1.0
    return Solid((mark.X_WF @ vertices, faces), FEET[mark.foot], opacity)


@cache
def mark_triangles(kind: str, sole: SoleSize) -> Triangles:
    """Makes the triangles of a mark in the sole's frame.

    An outline shows a commanded step, dashes one that is not taken as commanded, a
    filled sole one that has landed.
    """
    outline = sole_outline(sole)
    if kind == LANDED:
        return polygon(outline)
    every = slice(None, None, 2 if kind == SATURATED else 1)
    return ribbons(
        outline[:, every], np.roll(outline, -1, axis=1)[:, every], LINE_WIDTH
    )


def sole_outline(sole: SoleSize) -> Points:
    """Computes the outline of a sole, counter-clockwise in its frame [m], (3, k)."""
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
