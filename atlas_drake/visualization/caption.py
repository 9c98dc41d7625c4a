"""A caption with the robot's behavior, fixed to the picture like a subtitle.

The text is drawn in front of the camera, so it faces the viewer from everywhere, and
appears in recordings, which a label beside the 3D view would not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat, Rgba
from pydrake.math import RigidTransform

from atlas_drake.errors import ErrorCode
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasBehaviorManipulateFeedback,
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.records import TickRecord
from atlas_drake.visualization.scene import FIELD_OF_VIEW
from atlas_drake.visualization.shapes import draw_flat, ribbons
from atlas_drake.visualization.stroke_font import text_segments

DISTANCE = 0.5
"""Distance of the text from the camera [m]: nearer than all visible objects."""
HALF_PICTURE = DISTANCE * math.tan(0.5 * math.radians(FIELD_OF_VIEW))
"""Half the height of the picture at that distance [m]; the numbers below are shares of
it."""
TITLE_HEIGHT, NOTE_HEIGHT = 0.075, 0.034
"""Heights of the letters."""
TITLE_Y, NOTE_Y, FLAGS_Y = 0.83, 0.74, 0.68
"""Heights of the baselines above the middle of the picture."""
STROKE = 0.13
"""Width of a stroke as a share of the letters' height."""
COLOR = Rgba(0.13, 0.17, 0.22, 1.0)


ARRIVED = 1e-3
"""Distance to its goal below which the pelvis' reference has arrived [m or rad]."""
_TRANSITION = {
    BehaviorStatus.TRANSITION_IN_PROGRESS: "transition in progress",
    BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR: "unknown behavior",
    BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR: "illegal transition",
    BehaviorStatus.FAILED_TRANS_COM_POS: "refused: CoM not over the feet",
    BehaviorStatus.FAILED_TRANS_COM_VEL: "refused: CoM too fast",
    BehaviorStatus.FAILED_TRANS_VEL: "refused: joints too fast",
    BehaviorStatus.WARNING_AUTO_TRANS: "ended by itself",
    BehaviorStatus.ERROR_FALLING: "falling",
}
_WALK = {
    WalkStatus.SUBSTATE_SWAYING: "swaying",
    WalkStatus.SUBSTATE_STEPPING: "stepping",
    WalkStatus.SUBSTATE_CATCHING: "catching",
    WalkStatus.WARNING_INSUFFICIENT_STEP_DATA: "out of steps",
    WalkStatus.ERROR_INCONSISTENT_STEPS: "inconsistent steps",
}
_STEP = {
    StepStatus.SUBSTATE_SWAYING: "swaying",
    StepStatus.SUBSTATE_STEPPING: "stepping",
}


def caption_of(
    record: TickRecord, catalog: BehaviorCatalog = SHIPPED
) -> tuple[str, str]:
    """Makes title and note about the behavior of a robot with these behaviors."""
    shares = record.joints.k_effort.tolist()
    users = sum(share >= K_EFFORT_MAX for share in shares)
    blended = sum(0 < share < K_EFFORT_MAX for share in shares)
    entry = catalog.entry(catalog.find(record.behavior.current))
    behavior = entry.behavior
    note = f"{users} of {len(shares)} joints under user control"
    if users == 0 and behavior is not Behavior.NONE:
        note = "all joints under behavior control"
    if blended:
        note = f"{note}, {blended} shared"
    if record.behavior.status_flags & BehaviorStatus.ERROR_FALLING:
        return "falling", note
    if users == len(shares) or behavior is Behavior.USER:
        return "user", "all joints under user control"
    if behavior is Behavior.NONE:  # A controller without behaviors reports NONE.
        return "no behavior", note
    walk, step = record.walk, record.step
    if walk.status_flags & WalkStatus.SUBSTATE_STEPPING:
        return f"{entry.title} - step {max(walk.current_step_index, 1)}", note
    if step.status_flags & StepStatus.SUBSTATE_STEPPING:
        return f"{entry.title} - step {step.current_step_index}", note
    return entry.title, note


def feedback_words(record: TickRecord) -> str:
    """Describes the flags: substate, transition, errors; "ok" if there is none."""
    words = _said(record.walk.status_flags, _WALK)
    words += _said(record.step.status_flags, _STEP)
    if record.behavior.current == Behavior.MANIPULATE:
        words += _pelvis_words(record.manipulate)
    words += _said(record.behavior.status_flags, _TRANSITION)
    error = ErrorCode(record.behavior.error_code)
    if error != ErrorCode.NO_ERRORS:
        words.append(f"error: {error.name.replace('_', ' ')}")
    return ", ".join(words) or "ok"


def _pelvis_words(feedback: AtlasBehaviorManipulateFeedback) -> list[str]:
    """Describes if the reference of MANIPULATE, which has no flags, has arrived."""
    goal, now = feedback.clamped, feedback.internal_desired
    arrived = all(
        abs(getattr(goal, field.name) - getattr(now, field.name)) < ARRIVED
        for field in fields(goal)
    )
    return [] if arrived else ["pelvis moves"]


def _said(flags: int, words: Mapping[Any, str]) -> list[str]:
    return [text for flag, text in words.items() if flags & flag]


@dataclass(frozen=True)
class CaptionLine:
    """A line of text; height and baseline as shares of half the picture."""

    text: str
    height: float
    y: float


def caption_lines(title: str, notes: Sequence[str]) -> list[CaptionLine]:
    """Puts a title and up to two notes into their places."""
    places = zip(notes, (NOTE_Y, FLAGS_Y), strict=False)
    return [
        CaptionLine(title, TITLE_HEIGHT, TITLE_Y),
        *(CaptionLine(note, NOTE_HEIGHT, y) for note, y in places),
    ]


def draw_line(meshcat: Meshcat, path: str, line: object) -> None:
    """Draws a ``CaptionLine`` in Meshcat, below the path of the camera."""
    assert isinstance(line, CaptionLine)
    height = HALF_PICTURE * line.height
    starts, ends = text_segments(line.text, height)
    draw_flat(meshcat, path, *ribbons(starts, ends, STROKE * height), COLOR)
    p_CT: Any = np.array([0.0, HALF_PICTURE * line.y, -DISTANCE])
    meshcat.SetTransform(path, RigidTransform(p_CT))
