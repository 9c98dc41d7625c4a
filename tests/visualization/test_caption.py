"""The caption agrees with the report, in letters of the stroke font."""

from dataclasses import replace
from itertools import product

import pytest

from atlas_drake.messages import (
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    WalkStatus,
)
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.visualization.caption import caption_of
from atlas_drake.visualization.stroke_font import _GLYPHS


def report(behavior, k_effort, falling=False, walk_flags=0, step=0):
    state = AtlasSimInterfaceState()
    state.current_behavior = behavior
    state.k_effort = k_effort
    if falling:
        state.behavior_feedback.status_flags = BehaviorStatus.ERROR_FALLING
    state.walk_feedback.status_flags = walk_flags
    state.walk_feedback.current_step_index = step
    return state


BEHAVIORS = "all joints under behavior control"
USERS = "all joints under user control"


@pytest.mark.parametrize(
    ("state", "title", "note"),
    [
        (report(Behavior.STAND, [0, 0, 0]), "STAND", BEHAVIORS),
        (report(Behavior.STAND, [255, 255, 255]), "user", USERS),
        (report(Behavior.USER, [255, 255, 255]), "user", USERS),
        (
            report(Behavior.STAND_PREP, [255, 0, 0]),
            "STAND PREP",
            "1 of 3 joints under user control",
        ),
        (
            report(Behavior.STAND, [255, 128, 0]),
            "STAND",
            "1 of 3 joints under user control, 1 shared",
        ),
        (
            report(Behavior.WALK, [0], walk_flags=WalkStatus.SUBSTATE_SWAYING),
            "WALK",
            BEHAVIORS,
        ),
        (
            report(Behavior.WALK, [0], walk_flags=WalkStatus.SUBSTATE_STEPPING, step=3),
            "WALK - step 3",
            BEHAVIORS,
        ),
        (report(Behavior.WALK, [0], falling=True), "falling", BEHAVIORS),
    ],
)
def test_captions(state, title, note):
    assert caption_of(state) == (title, note)


def test_the_caption_of_a_behavior_derived_from_walk_has_its_step():
    own = replace(SHIPPED.entry(Behavior.WALK), name="MY_WALK", number=160)
    state = report(own.behavior, [0], walk_flags=WalkStatus.SUBSTATE_STEPPING, step=2)
    title, _ = caption_of(state, BehaviorCatalog((*SHIPPED, own)))
    assert title == "MY WALK - step 2"


def test_the_font_has_every_letter_of_every_caption():
    flags = WalkStatus.SUBSTATE_STEPPING
    shares = [0] * 28, [255] * 28, [255] * 5 + [128] * 23
    for behavior, k_effort, falling in product(Behavior, shares, (False, True)):
        state = report(behavior, k_effort, falling, flags, step=1234567890)
        for line in caption_of(state):
            assert set(line.upper()) <= set(_GLYPHS)
