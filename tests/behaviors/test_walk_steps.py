"""The steps that a walk takes: absolute and relative heights, and the demo walk."""

import math
from dataclasses import replace

import numpy as np
import pytest

from atlas_drake.behaviors.walk.steps import steps_asked_for
from atlas_drake.control.feet.footstep import (
    ensure_clearance,
    limit_duration,
    outward,
    resolve_height,
    saturate,
    shortest_duration,
)
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages import AtlasBehaviorStepData, AtlasBehaviorWalkParams
from atlas_drake.messages.footstep import LEFT, RIGHT, UP, FootPose, Footstep
from atlas_drake.planning.demo_steps import DEMO_STEPS, demo_steps
from atlas_drake.planning.footholds import Gait
from atlas_drake.rotations import rotation_z

LIMITS, GAIT = StepLimits(), Gait()
GROUND = 1.0
"""Height of the stance foot [m]."""
STANCE = FootPose(np.array([0.2, -0.1, GROUND]), np.eye(3))
PITCH = 0.1
TILTED = np.array([math.sin(PITCH), 0.0, math.cos(PITCH)])


def step(z, *, relative=False, normal=TILTED):
    return Footstep(1, LEFT, np.array([0.4, 0.1, z]), 0.0, 0.63, 0.1, normal, relative)


@pytest.mark.parametrize("rise", [-0.1, -0.05, 0.0, 0.05, 0.1])
def test_a_height_near_the_stance_foot_is_taken(rise):
    absolute = resolve_height(step(GROUND + rise), STANCE, LIMITS)
    relative = resolve_height(step(rise, relative=True), STANCE, LIMITS)
    for taken in (absolute, relative):
        assert not taken.relative
        assert taken.p_WF[2] == pytest.approx(GROUND + rise)
        np.testing.assert_array_equal(taken.normal, TILTED)
        # And it is one that can be done.
        done = saturate(taken, STANCE, LIMITS)
        np.testing.assert_allclose(done.p_WF, taken.p_WF, atol=1e-12)
        np.testing.assert_array_equal(done.normal, TILTED)


@pytest.mark.parametrize("z", [0.0, GROUND + 0.9, GROUND - 5.0])
def test_a_height_far_from_the_stance_foot_is_ignored_with_the_normal(z):
    taken = resolve_height(step(z), STANCE, LIMITS)
    np.testing.assert_array_equal(taken.p_WF, [0.4, 0.1, GROUND])
    np.testing.assert_array_equal(taken.normal, UP)


@pytest.mark.parametrize("climb", [-0.1, -0.02, 0.0, 0.02, 0.1])
def test_a_climb_needs_a_swing_that_clears_it(climb):
    start = FootPose(np.array([0.0, 0.1, GROUND]), np.eye(3))
    low = replace(step(GROUND + climb), swing_height=LIMITS.swing_height.least)
    done = ensure_clearance(low, start, LIMITS)
    # Counted from the middle of its ends, the apex lies above the higher one.
    above = done.swing_height - 0.5 * abs(climb)
    assert above == pytest.approx(LIMITS.swing_height.least + 0.5 * abs(climb))
    high = replace(low, swing_height=0.25)
    assert ensure_clearance(high, start, LIMITS).swing_height == 0.25


@pytest.mark.parametrize("foot_first", [True, False])
@pytest.mark.parametrize(
    ("apart", "longest"),
    [
        (0.2, LIMITS.duration.greatest),
        (LIMITS.near, LIMITS.duration.greatest),
        (LIMITS.far, LIMITS.far_duration),
        (0.8, LIMITS.far_duration),
    ],
)
def test_feet_far_apart_limit_the_duration(apart, longest, foot_first):
    # Whether they are before the step or after it.
    near, away = np.array([0.0, 0.0, GROUND]), np.array([0.0, apart, GROUND])
    stance = FootPose(near, np.eye(3))
    begin, end = (away, near) if foot_first else (near, away)
    for duration in (0.6, 2.9):
        sent = replace(step(GROUND), p_WF=end, duration=duration)
        done = limit_duration(sent, FootPose(begin, np.eye(3)), stance, LIMITS)
        assert done.duration == pytest.approx(min(duration, longest))
    # The limit for feet far apart may be either end of that for all feet.
    for longest in LIMITS.duration:
        replace(LIMITS, far_duration=longest).check()


@pytest.mark.parametrize("foot_first", [True, False])
@pytest.mark.parametrize(
    ("climb", "shortest"),
    [(0.0, 0.6), (0.10, 0.6), (-0.10, 0.6), (0.125, 0.85), (0.15, 1.1), (-0.16, 1.1)],
)
def test_a_step_to_another_level_takes_its_time(climb, shortest, foot_first):
    # Whether its foot leaves the other level or goes there.
    limits = replace(LIMITS, rise=0.15)
    near, there = np.array([0.0, 0.0, GROUND]), np.array([0.3, 0.2, GROUND + climb])
    stance = FootPose(near, np.eye(3))
    begin, end = (there, near) if foot_first else (near, there)
    for duration in (0.6, 2.0):
        sent = replace(step(GROUND), p_WF=end, duration=duration)
        done = limit_duration(sent, FootPose(begin, np.eye(3)), stance, limits)
        assert done.duration == pytest.approx(max(duration, shortest))
    # Robots that do not take larger steps take all of them in any time.
    assert shortest_duration(climb, LIMITS) == LIMITS.duration.least


def feet(x=0.0, y=0.0, yaw=0.0, width=0.3):
    side = rotation_z(yaw) @ [0.0, 0.5 * width, 0.0]
    middle = np.array([x, y, 0.2])
    return [
        FootPose(middle + outward(foot) * side, rotation_z(yaw))
        for foot in (LEFT, RIGHT)
    ]


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_the_demonstration_walks_straight_ahead_and_ends_side_by_side(yaw):
    steps = demo_steps(feet(1.0, 2.0, yaw), 1, LEFT, GAIT)
    assert [s.index for s in steps] == list(range(1, DEMO_STEPS + 1))
    assert [s.foot for s in steps] == [LEFT, RIGHT] * 12 + [LEFT]
    # In the frame in which it walks along x from the middle of the feet.
    places = [rotation_z(yaw).T @ (s.p_WF - [1.0, 2.0, 0.0]) for s in steps]
    ahead = np.array([place[0] for place in places])
    lengths = np.diff(ahead)
    np.testing.assert_allclose(lengths[:-1], ahead[0], atol=1e-9)
    assert ahead[0] == pytest.approx(GAIT.stride)
    assert lengths[-1] == pytest.approx(0.0)
    sides = [outward(s.foot) * p[1] for s, p in zip(steps, places, strict=True)]
    np.testing.assert_allclose(sides, GAIT.half_width)
    for s in steps:
        assert s.yaw == pytest.approx(yaw)
        # Wherever the ground is.
        assert s.relative
        assert s.p_WF[2] == 0.0


@pytest.mark.parametrize("last", [LEFT, RIGHT])
def test_a_demonstration_that_takes_over_continues_with_the_other_foot(last):
    params = AtlasBehaviorWalkParams(use_demo_walk=True)
    steps = steps_asked_for((), params, feet(), 7, GAIT, last_foot=last)
    assert (steps[0].index, steps[0].foot) == (7, 1 - last)
    assert steps[-1].index == DEMO_STEPS
    assert steps_asked_for((), params, feet(), DEMO_STEPS + 1, GAIT, last) == ()


@pytest.mark.parametrize("relative", [False, True])
def test_steps_keep_whether_their_height_is_relative(relative):
    params = AtlasBehaviorWalkParams(use_relative_step_height=relative)
    params.step_queue[0] = AtlasBehaviorStepData(step_index=1, duration=0.63)
    (taken,) = steps_asked_for((), params, feet(), 1, GAIT)
    assert taken.relative is relative
