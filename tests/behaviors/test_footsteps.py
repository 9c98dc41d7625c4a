"""The queue of steps: read from messages, merged by index, checked for order."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw

from atlas_drake.behaviors.footsteps import merge, next_runs, replaced, step_data_from
from atlas_drake.messages import AtlasBehaviorStepData, Pose, Quaternion, Vector3
from atlas_drake.messages.footstep import LEFT, RIGHT, Footstep, footstep_from


def data(index, foot=LEFT, yaw=0.0, x=0.0):
    """A step as a message has it."""
    half = 0.5 * yaw
    return AtlasBehaviorStepData(
        step_index=index,
        foot_index=foot,
        duration=0.63,
        swing_height=0.2,
        pose=Pose(
            Vector3(x, 0.15, 0.02),
            Quaternion(0.0, 0.0, math.sin(half), math.cos(half)),
        ),
    )


def step(index, foot=LEFT, x=0.0):
    return Footstep(index, foot, np.array([x, 0.15, 0.02]), 0.0, 0.63, 0.2)


def indices(steps):
    return [step.index for step in steps]


def test_a_footstep_has_the_fields_of_its_message():
    footstep = footstep_from(data(3, RIGHT, yaw=0.7, x=1.5))
    assert (footstep.index, footstep.foot) == (3, RIGHT)
    np.testing.assert_array_equal(footstep.p_WF, [1.5, 0.15, 0.02])
    assert footstep.yaw == pytest.approx(0.7)
    assert (footstep.duration, footstep.swing_height) == (0.63, 0.2)
    # Heights are in the world unless the message says otherwise.
    assert not footstep.relative
    assert not merge((), [data(3)], 1)[0].relative


@given(
    rpy=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-3.1, 3.1)),
    scale=st.sampled_from([1.0, 0.01, 3.0, -20.0]),
)
def test_yaw_is_the_heading_of_the_toes_for_a_quaternion_of_any_length(rpy, scale):
    sent = data(1)
    wxyz = RollPitchYaw(*rpy).ToQuaternion().wxyz()
    sent.pose.orientation = Quaternion.from_wxyz(scale * wxyz)
    assert footstep_from(sent).yaw == pytest.approx(rpy[2], abs=1e-9)


def test_a_message_replaces_steps_that_have_not_begun():
    pending = (step(3, x=0.3), step(4, x=0.4))
    merged = merge(pending, [data(4, x=9.0), data(5, x=0.5)], first_open=3)
    assert indices(merged) == [3, 4, 5]
    assert [s.p_WF[0] for s in merged] == [0.3, 9.0, 0.5]


def test_steps_that_have_begun_are_not_changed():
    merged = merge((step(3),), [data(1), data(2), data(3, x=9.0)], first_open=3)
    assert indices(merged) == [3]
    assert merged[0].p_WF[0] == 9.0
    assert merge((), [data(1), data(2)], first_open=3) == ()


def test_steps_beyond_a_gap_of_indices_are_not_next():
    pending = (step(3), step(4), step(6), step(7))
    assert indices(next_runs(pending, 3, most=4)) == [3, 4]
    assert indices(next_runs(pending[2:], 6, most=4)) == [6, 7]
    assert indices(next_runs(pending[2:], 6, most=1)) == [6]
    assert next_runs(pending[2:], 5, most=4) == ()
    assert next_runs((), 1, most=4) == ()


def test_a_tilted_step_goes_to_a_message_and_back():
    normal = np.array([0.1, -0.15, 1.0]) / np.linalg.norm([0.1, -0.15, 1.0])
    tilted = Footstep(2, RIGHT, np.array([0.4, -0.1, 0.1]), 0.8, 1.0, 0.1, normal)
    again = footstep_from(step_data_from(tilted))
    np.testing.assert_array_equal(again.p_WF, tilted.p_WF)
    np.testing.assert_allclose(again.normal, normal, atol=1e-12)
    assert again.yaw == pytest.approx(0.8)
    for name in ("index", "foot", "duration", "swing_height"):
        assert getattr(again, name) == getattr(tilted, name)


def test_replaced_steps_are_those_with_another_content():
    before = merge((), [data(1), data(2)], 1)
    assert replaced(before, merge(before, [data(1), data(2)], 1)) == set()
    assert replaced(before, merge(before, [data(2, x=0.1), data(3)], 1)) == {2, 3}
    assert replaced(before, merge(before, [data(1)], 1, relative=True)) == {1}
