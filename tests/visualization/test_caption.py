"""Captions and feedback in words: what they say, in letters of the stroke font."""

from dataclasses import replace
from itertools import product

import pytest

from atlas_drake.errors import ErrorCode
from atlas_drake.messages import (
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.visualization.caption import caption_of, feedback_words
from atlas_drake.visualization.stroke_font import _GLYPHS

SWAYING, STEPPING = WalkStatus.SUBSTATE_SWAYING, WalkStatus.SUBSTATE_STEPPING
BEHAVIORS = "all joints under behavior control"
USERS = "all joints under user control"
MY_WALK = replace(SHIPPED.entry(Behavior.WALK), name="MY_WALK", number=160)


def report(
    behavior=Behavior.STAND, flags=0, walk=0, step=0, error=0, k_effort=(0,), index=0
):
    state = AtlasSimInterfaceState()
    state.current_behavior = behavior
    state.k_effort = list(k_effort)
    state.behavior_feedback.status_flags = flags
    state.walk_feedback.status_flags = walk
    state.walk_feedback.current_step_index = index
    state.step_feedback.status_flags = step
    state.error_code = error
    return state


@pytest.mark.parametrize(
    ("state", "title", "note"),
    [
        (report(), "STAND", BEHAVIORS),
        (report(k_effort=[255, 255, 255]), "user", USERS),
        (report(Behavior.USER, k_effort=[255, 255, 255]), "user", USERS),
        (
            report(Behavior.STAND_PREP, k_effort=[255, 0, 0]),
            "STAND PREP",
            "1 of 3 joints under user control",
        ),
        (
            report(k_effort=[255, 128, 0]),
            "STAND",
            "1 of 3 joints under user control, 1 shared",
        ),
        (report(Behavior.WALK, walk=SWAYING), "WALK", BEHAVIORS),
        (report(Behavior.WALK, walk=STEPPING, index=3), "WALK - step 3", BEHAVIORS),
        (
            report(MY_WALK.behavior, walk=STEPPING, index=2),
            "MY WALK - step 2",
            BEHAVIORS,
        ),
        (report(Behavior.WALK, BehaviorStatus.ERROR_FALLING), "falling", BEHAVIORS),
    ],
)
def test_captions(state, title, note):
    assert caption_of(state, BehaviorCatalog((*SHIPPED, MY_WALK))) == (title, note)


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (report(), "ok"),
        (report(flags=BehaviorStatus.TRANSITION_SUCCESS), "ok"),
        (
            report(flags=BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR),
            "illegal transition",
        ),
        (report(Behavior.WALK, walk=SWAYING), "swaying"),
        (
            report(
                Behavior.WALK,
                BehaviorStatus.TRANSITION_IN_PROGRESS,
                WalkStatus.SUBSTATE_CATCHING
                | WalkStatus.WARNING_INSUFFICIENT_STEP_DATA,
            ),
            "catching, out of steps, transition in progress",
        ),
        (report(Behavior.STEP, step=StepStatus.SUBSTATE_STEPPING), "stepping"),
        (report(MY_WALK.behavior, walk=STEPPING), "stepping"),
        (report(error=ErrorCode.VALUE_OUT_OF_RANGE), "error: VALUE OUT OF RANGE"),
    ],
)
def test_flags_in_words(message, words):
    assert feedback_words(message) == words


def test_feedback_of_manipulate_tells_whether_the_pelvis_moves():
    message = report(Behavior.MANIPULATE)
    assert feedback_words(message) == "ok"
    message.manipulate_feedback.clamped.pelvis_yaw = 0.1
    assert feedback_words(message) == "pelvis moves"
    assert set("PELVIS MOVES") <= set(_GLYPHS)
    message.manipulate_feedback.internal_desired.pelvis_yaw = 0.1
    assert feedback_words(message) == "ok"


def test_the_font_has_every_letter_of_every_caption_and_feedback():
    shares = [0] * 28, [255] * 28, [255] * 5 + [128] * 23
    falling = BehaviorStatus.ERROR_FALLING
    states = [
        report(behavior, flags, STEPPING, k_effort=k_effort, index=1234567890)
        for behavior, k_effort, flags in product(Behavior, shares, (0, falling))
    ]
    states += [
        report(Behavior.WALK, sum(BehaviorStatus), sum(WalkStatus), sum(StepStatus), e)
        for e in ErrorCode
    ]
    for state in states:
        for line in (*caption_of(state), feedback_words(state)):
            assert set(line.upper()) <= set(_GLYPHS)
