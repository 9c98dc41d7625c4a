"""The feedback flags of a report in words.

Text only; ``caption`` draws it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from atlas_drake.errors import ErrorCode
from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)

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


def feedback_words(report: AtlasSimInterfaceState) -> str:
    """Describes the flags: substate, transition, errors; "ok" if there is none."""
    words = _said(report.walk_feedback.status_flags, _WALK)
    words += _said(report.step_feedback.status_flags, _STEP)
    if report.current_behavior == Behavior.MANIPULATE:
        words += _pelvis_words(report.manipulate_feedback)
    words += _said(report.behavior_feedback.status_flags, _TRANSITION)
    if report.error_code != ErrorCode.NO_ERRORS:
        words.append(f"error: {ErrorCode(report.error_code).name.replace('_', ' ')}")
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
