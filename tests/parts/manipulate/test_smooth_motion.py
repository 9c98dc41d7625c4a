"""Smooth motion to a goal: arrival, no overshoot, bounded speed and acceleration."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from atlas_drake.parts.manipulate.pelvis_pose import MotionLimits, at_rest

DT = 0.01
LIMITS = MotionLimits(speed=0.12, acceleration=0.4)
PLACES = st.floats(-0.5, 0.5)


def travel(goals, seconds, begin=(0.0,), limits=LIMITS):
    """Motions on the way to one goal after the other, each for so long."""
    motion = at_rest(np.array(begin, dtype=float))
    path = [motion]
    for goal in goals:
        for _ in range(round(seconds / DT)):
            motion = motion.towards(np.array(goal, dtype=float), limits, DT)
            path.append(motion)
    return path


def test_the_goal_is_reached_at_nearly_full_speed():
    path = travel([[0.24]], 4.0)
    assert path[-1].position[0] == pytest.approx(0.24, abs=1e-3)
    assert path[round(2.0 / DT)].position[0] < 0.23


@settings(max_examples=30)
@given(goals=st.lists(PLACES, min_size=1, max_size=4), seconds=st.floats(0.1, 2.0))
def test_speed_and_acceleration_are_limited_when_the_goal_jumps(goals, seconds):
    path = travel([[goal] for goal in goals], seconds)
    velocity = np.array([motion.velocity[0] for motion in path])
    assert np.abs(velocity).max() <= LIMITS.speed * (1.0 + 1e-9)
    assert np.abs(np.diff(velocity)).max() <= LIMITS.acceleration * DT * (1.0 + 1e-9)
    # Each is the rate of the one before.
    position = np.array([motion.position[0] for motion in path])
    np.testing.assert_allclose(np.diff(position), velocity[1:] * DT, atol=1e-12)
    acceleration = np.array([motion.acceleration[0] for motion in path])
    np.testing.assert_allclose(np.diff(velocity), acceleration[1:] * DT, atol=1e-12)
    # It never leaves the range of its goals.
    assert position.min() >= min(0.0, *goals) - 1e-4
    assert position.max() <= max(0.0, *goals) + 1e-4


def test_the_way_from_rest_is_straight():
    path = travel([[0.3, 0.1]], 3.0, begin=(0.0, 0.0))
    for motion in path:
        assert motion.position[1] == pytest.approx(motion.position[0] / 3.0)


def test_limits_that_could_not_brake_are_refused():
    with pytest.raises(ValueError, match="does not stop"):
        MotionLimits(speed=1.0, acceleration=0.5)
