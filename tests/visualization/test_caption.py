"""Captions and feedback in words: what they say, in letters of the stroke font."""

from itertools import combinations, product

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.visualization.caption import caption_of, feedback_words
from atlas_drake.visualization.stroke_font import text_segments

SWAYING, STEPPING = WalkStatus.SUBSTATE_SWAYING, WalkStatus.SUBSTATE_STEPPING
MY_WALK = replace(SHIPPED.entry(Behavior.WALK), name="MY_WALK", number=160)


@pytest.fixture
def report(record_of):
    """Makes a record from what captions are about."""

    def report(
        behavior=Behavior.STAND, flags=0, walk=0, step=0, error=0, shares=(0,), index=0
    ):
        return record_of(
            behavior={"current": behavior, "status_flags": flags, "error_code": error},
            joints={"k_effort": np.array(shares)},
            walk=AtlasBehaviorWalkFeedback(status_flags=walk, current_step_index=index),
            step=AtlasBehaviorStepFeedback(status_flags=step, current_step_index=index),
        )

    return report


@pytest.mark.parametrize(
    ("fields", "title", "notes"),
    [
        ({}, "STAND", ["all", "behavior"]),
        ({"shares": [255] * 3}, "user", ["all", "user"]),
        ({"behavior": Behavior.USER, "shares": [0] * 3}, "user", ["all", "user"]),
        (
            {"behavior": Behavior.STAND_PREP, "shares": [255, 0, 0]},
            "STAND PREP",
            ["1 of 3", "user"],
        ),
        ({"shares": [255, 128, 0]}, "STAND", ["1 of 3", "user", "1 shared"]),
        ({"behavior": Behavior.WALK, "walk": SWAYING}, "WALK", ["behavior"]),
        ({"behavior": Behavior.WALK, "walk": STEPPING, "index": 3}, "step 3", []),
        ({"behavior": MY_WALK.behavior, "walk": STEPPING, "index": 2}, "MY WALK", []),
        (
            {"behavior": Behavior.STEP, "step": StepStatus.SUBSTATE_STEPPING},
            "STEP",
            [],
        ),
        (
            {"behavior": Behavior.WALK, "flags": BehaviorStatus.ERROR_FALLING},
            "falling",
            ["behavior"],
        ),
    ],
)
def test_captions(fields, title, notes, report):
    catalog = BehaviorCatalog((*SHIPPED, MY_WALK))
    said, note = caption_of(report(**fields), catalog)
    assert title in said
    assert [part for part in notes if part not in note] == []


@pytest.mark.parametrize(
    ("field", "kind", "silent"),
    [
        ("flags", BehaviorStatus, {BehaviorStatus.TRANSITION_SUCCESS}),
        ("walk", WalkStatus, set()),
        ("step", StepStatus, set()),
        ("error", ErrorCode, {ErrorCode.NO_ERRORS}),
    ],
)
def test_every_flag_has_words_of_its_own(field, kind, silent, report):
    words = {flag: feedback_words(report(**{field: flag})) for flag in kind}
    nothing = feedback_words(report())
    assert {flag for flag in kind if words[flag] == nothing} == silent
    spoken = set(kind) - silent
    assert len({words[flag] for flag in spoken}) == len(spoken)
    if kind is ErrorCode:
        return
    for pair in combinations(spoken, 2):
        both = feedback_words(report(**{field: sum(pair)}))
        assert all(words[flag] in both for flag in pair)


def test_feedback_of_manipulate_tells_whether_the_pelvis_moves(record_of):
    goal, start = AtlasBehaviorPelvisServoParams(), AtlasBehaviorPelvisServoParams()
    goal.pelvis_yaw = 0.1

    def words(clamped, now, behavior=Behavior.MANIPULATE):
        feedback = AtlasBehaviorManipulateFeedback(
            clamped=clamped, internal_desired=now
        )
        return feedback_words(
            record_of(behavior={"current": behavior}, manipulate=feedback)
        )

    assert "pelvis" in words(goal, start)
    for at_rest in (words(goal, goal), words(goal, start, Behavior.STAND)):
        assert "pelvis" not in at_rest


def test_the_font_has_every_letter_of_every_caption_and_feedback(report):
    shares = [0] * 28, [255] * 28, [255] * 5 + [128] * 23
    records = [
        report(behavior, flags, STEPPING, shares=share, index=1234567890)
        for behavior, share, flags in product(
            Behavior, shares, (0, BehaviorStatus.ERROR_FALLING)
        )
    ]
    every_flag = sum(BehaviorStatus), sum(WalkStatus), sum(StepStatus)
    records += [report(Behavior.WALK, *every_flag, error) for error in ErrorCode]
    lines = [line for r in records for line in (*caption_of(r), feedback_words(r))]
    letters = set("".join([*lines, "pelvis moves", "paused"]))
    missing = np.hstack(text_segments("\u20ac", 1.0))  # A box.
    lacking = [
        letter
        for letter in letters
        if np.array_equal(np.hstack(text_segments(letter, 1.0)), missing)
    ]
    assert lacking == []
