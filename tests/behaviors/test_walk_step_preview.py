"""The coming steps of a walk: saturation, obstacles, warnings, timing."""

import dataclasses
import math

import numpy as np
import pytest

from atlas_drake.behaviors.footsteps import (
    footstep_event,
    landed_elsewhere,
    out_of_reach,
)
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.steps import WalkProgress, with_warnings
from atlas_drake.control.feet.footstep import outward
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep, is_elsewhere
from atlas_drake.rotations import rotation_z

CONFIG = WalkConfig()
LIMITS = CONFIG.limits
HALF_WIDTH = 0.12
GROUND = 0.3
"""Height of both soles [m]."""


def foot_at(foot, x=0.0, yaw=0.0, z=GROUND, y=None):
    y = outward(foot) * HALF_WIDTH if y is None else y
    return FootPose(np.array([x, y, z]), rotation_z(yaw))


def step(index, x=0.0, *, yaw=0.0, z=GROUND, foot=None, y=None, **changes):
    foot = (index - 1) % 2 if foot is None else foot
    y = outward(foot) * HALF_WIDTH if y is None else y
    taken = Footstep(index, foot, np.array([x, y, z]), yaw, 0.63, 0.1)
    return dataclasses.replace(taken, **changes)


def progress_with(steps, feet=None, aimed=None, **changes):
    """A walk with these steps to come; it has no message."""
    feet = feet or (foot_at(LEFT), foot_at(RIGHT))
    progress = WalkProgress(feet, aimed or feet, tuple(steps), 1, None, CONFIG)
    return dataclasses.replace(progress, **changes)


def preview_of(*arguments, **changes):
    return progress_with(*arguments, **changes).preview


def texts(progress):
    """The warnings about the coming steps, which are given once."""
    warned, news = with_warnings(progress, 1.0)
    assert with_warnings(warned, 2.0) == (warned, ())
    return [event.text for event in news]


@pytest.mark.parametrize("short", [0.0, 0.005, 0.015])
@pytest.mark.parametrize("ahead", [1, -1])
def test_a_landing_error_does_not_reduce_the_next_step(short, ahead):
    length = LIMITS.forward if ahead > 0 else -LIMITS.backward
    feet = (foot_at(LEFT), foot_at(RIGHT, -ahead * short))
    aimed = (foot_at(LEFT), foot_at(RIGHT))
    progress = progress_with([step(1, length), step(2, 2 * length)], feet, aimed)
    places = [taken.p_WF[0] for taken in progress.coming]
    np.testing.assert_allclose(places, [length, 2 * length])
    assert texts(progress) == []


def test_turns_count_from_the_heading_that_was_planned_too():
    feet = (foot_at(LEFT), foot_at(RIGHT, yaw=-0.03))
    aimed = (foot_at(LEFT), foot_at(RIGHT))
    (taken,) = preview_of([step(1, yaw=LIMITS.toe_out)], feet, aimed).steps
    assert taken.yaw == pytest.approx(LIMITS.toe_out)


def test_the_step_in_the_air_is_where_the_next_one_begins():
    feet = (foot_at(LEFT), foot_at(RIGHT))
    in_air = step(1, 0.3)
    progress = progress_with(
        [step(2, 5.0)], feet, in_air=in_air, last_foot=LEFT, next_index=2
    )
    assert progress.coming[0] is in_air
    # Balance may have moved it: that is no saturation.
    (text,) = texts(progress)
    assert text.startswith("step 2")
    assert progress.coming[1].p_WF[0] == pytest.approx(0.3 + LIMITS.forward)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("relative", [True, False])
def test_a_step_too_high_is_an_obstacle(sign, relative):
    rise = sign * 0.15
    steps = [
        step(1, 0.2, z=0.0 if relative else GROUND, relative=relative),
        step(2, 0.4, z=rise if relative else GROUND + rise, relative=relative),
        step(3, 0.4, z=0.0, relative=True),
    ]
    progress = progress_with(steps)
    assert [taken.index for taken in progress.coming] == [1]
    assert progress.preview.blocked is steps[1]
    (text,) = texts(progress)
    way = "up" if sign > 0 else "down"
    expected = f"before step 2: step 2 leads 0.15 m {way}, which is too much"
    assert text.endswith(expected)


@pytest.mark.parametrize("error", [-0.005, 0.005])
def test_the_highest_step_may_be_a_little_higher_than_told(error):
    goal = step(1, 0.2, z=GROUND + LIMITS.rise)
    feet = (foot_at(LEFT), foot_at(RIGHT, z=GROUND - error))
    (taken,) = preview_of([goal], feet).steps
    # It ends where it was sent: there the ground is.
    assert taken.p_WF[2] == pytest.approx(GROUND + LIMITS.rise)


def test_a_step_up_that_is_out_of_reach_is_an_obstacle():
    step_preview = preview_of([step(1, 0.6, z=GROUND + 0.08)])
    assert step_preview.steps == ()
    assert "another level and is out of reach" in step_preview.obstacle


@pytest.mark.parametrize("relative", [False, True])
def test_a_stance_foot_on_a_brick_does_not_make_level_ground_another_level(relative):
    feet = (foot_at(LEFT), foot_at(RIGHT, z=GROUND + 0.05))
    aimed = (foot_at(LEFT), foot_at(RIGHT))
    goal = step(1, 0.6, z=0.0 if relative else GROUND, relative=relative)
    step_preview = preview_of([goal], feet, aimed)
    assert step_preview.obstacle == ""
    (taken,) = step_preview.steps
    assert taken.p_WF[0] == pytest.approx(LIMITS.forward)


def test_the_same_foot_again_is_an_obstacle():
    step_preview = preview_of([step(1, 0.2), step(2, 0.4, foot=LEFT), step(3, 0.4)])
    assert len(step_preview.steps) == 1
    assert step_preview.obstacle == "two steps in a row are for the same foot"


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        (step(1, 1.0), "ends 0.58 m from its place"),
        (step(1, 0.43), "ends 0.010 m from its place"),
        (step(1, yaw=0.78), "ends 0.28 rad from its heading"),
        (step(1, y=0.9, yaw=-0.4), "from its place and 0.15 rad from its heading"),
        (step(1, duration=0.4), "takes 0.60 s instead of 0.40 s"),
        (step(1, swing_height=0.6), "swings 0.30 m high instead of 0.60 m"),
        (
            step(1, normal=np.array([math.sin(0.5), 0.0, math.cos(0.5)])),
            "tilted 0.20 rad less than its normal",
        ),
    ],
    ids=["far", "little", "turned", "both", "fast", "high", "steep"],
)
def test_every_saturation_gives_one_warning(goal, text):
    progress, (event,) = with_warnings(progress_with([goal]), 2.5)
    assert event.kind == "warning"
    assert event.time == 2.5
    assert event.data["index"] == 1
    assert event.text.startswith("step 1 ")
    assert text in event.text
    assert with_warnings(progress, 3.0) == (progress, ())


@pytest.mark.parametrize(
    ("x", "yaw", "warned"),
    [(0.0009, 0.0, 0), (0.001, 0.0, 1), (0.0, 0.0099, 0), (0.0, -0.0101, 1)],
)
def test_a_saturation_above_rounding_gives_a_warning(x, yaw, warned):
    assert len(out_of_reach(0.0, step(1), step(1, x, yaw=yaw))) == warned


@pytest.mark.parametrize(
    ("away", "turned", "elsewhere"),
    [(0.049, 0.19, False), (0.05, 0.0, True), (0.0, 0.2, True)],
)
def test_a_landing_counts_as_elsewhere_from_its_thresholds_on(away, turned, elsewhere):
    assert is_elsewhere({"error_m": away, "error_rad": turned}) is elsewhere


def test_a_landing_elsewhere_is_not_what_was_asked_for():
    def landing(x=0.0, yaw=0.0):
        return footstep_event(0.0, step(1), step(1, x), foot_at(LEFT, x, yaw=yaw))

    events = (landing(0.04), landing(0.06), landing(yaw=0.1), landing(yaw=-0.3))
    assert [landed_elsewhere(event) for event in events] == [0, 1, 0, 1]
    # A warning is not the last word: a better step may still be sent.
    _, (far,) = with_warnings(progress_with([step(1, 1.0)]), 0.0)
    assert not landed_elsewhere(far)
    _, (turned,) = with_warnings(progress_with([step(1, yaw=0.785)]), 0.0)
    assert turned.data["error_rad"] == pytest.approx(0.285)


def test_a_landing_tells_how_far_it_is_off_in_place_and_heading():
    event = footstep_event(
        1.0, step(1, 1.0, yaw=3.1), step(1, 0.4), foot_at(LEFT, 0.41, yaw=-3.1, z=0.5)
    )
    assert event.text == "step 1 landed (left, 590 mm off, 200 mm too high)"
    assert event.data["height_error_m"] == pytest.approx(0.2)
    assert event.data["commanded"] == pytest.approx([1.0, HALF_WIDTH, 3.1])
    assert event.data["saturated"] == pytest.approx([0.4, HALF_WIDTH, 0.0])
    assert event.data["landed"] == pytest.approx([0.41, HALF_WIDTH, -3.1])
    assert event.data["error_m"] == pytest.approx(0.59)
    assert event.data["error_rad"] == pytest.approx(2 * math.pi - 6.2)
