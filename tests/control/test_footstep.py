"""Footsteps: saturation to the reach of the legs, equal on both sides."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atlas_drake.control.feet.footstep import outward, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z, wrap_angle

LIMITS = StepLimits()
FAR = st.floats(-2.0, 2.0)
YAWS = st.floats(-7.0, 7.0)
MIRROR = np.array([1.0, -1.0, 1.0])
"""Reflection at the plane y = 0."""


@st.composite
def situations(draw):
    """A commanded for a step and the foot that it is taken from."""
    stance_at = np.array([draw(FAR), draw(FAR), draw(FAR)])
    stance = FootPose(stance_at, rotation_z(draw(YAWS)))
    step = Footstep(
        index=draw(st.integers(1, 99)),
        foot=draw(st.sampled_from([LEFT, RIGHT])),
        p_WF=stance_at + np.array([draw(FAR), draw(FAR), draw(FAR)]),
        yaw=draw(YAWS),
        duration=draw(st.floats(0.01, 9.0)),
        swing_height=draw(st.floats(0.0, 2.0)),
    )
    return step, stance


def in_stance_frame(step, stance):
    """Forward, outward and upward distance, and the turn outward."""
    sign = outward(step.foot)
    x, y, z = rotation_z(stance.yaw).T @ (step.p_WF - stance.p_WF)
    return x, sign * y, z, sign * wrap_angle(step.yaw - stance.yaw)


def assert_same(step, other):
    assert step.action == other.action
    for field in dataclasses.fields(Footstep)[:-1]:
        np.testing.assert_allclose(
            getattr(step, field.name), getattr(other, field.name), atol=1e-9
        )


@given(situation=situations())
def test_saturated_steps_are_within_all_limits(situation):
    commanded, stance = situation
    step = saturate(commanded, stance, LIMITS)
    forward, width, rise, turn = in_stance_frame(step, stance)
    slack = 1e-9
    assert -LIMITS.backward - slack <= forward <= LIMITS.forward + slack
    assert LIMITS.width.least - slack <= width <= LIMITS.width.greatest + slack
    assert abs(rise) <= LIMITS.rise + slack
    assert -LIMITS.toe_in - slack <= turn <= LIMITS.toe_out + slack
    assert LIMITS.duration.least <= step.duration <= LIMITS.duration.greatest
    assert (
        LIMITS.swing_height.least <= step.swing_height <= LIMITS.swing_height.greatest
    )
    assert (step.index, step.foot) == (commanded.index, commanded.foot)


@given(situation=situations())
def test_saturating_twice_changes_nothing(situation):
    commanded, stance = situation
    once = saturate(commanded, stance, LIMITS)
    assert_same(saturate(once, stance, LIMITS), once)


@given(situation=situations())
def test_left_and_right_are_mirror_images(situation):
    commanded, stance = situation
    mirrored = saturate(
        dataclasses.replace(
            commanded,
            foot=1 - commanded.foot,
            p_WF=MIRROR * commanded.p_WF,
            yaw=-commanded.yaw,
        ),
        FootPose(MIRROR * stance.p_WF, rotation_z(-stance.yaw)),
        LIMITS,
    )
    step = saturate(commanded, stance, LIMITS)
    np.testing.assert_allclose(mirrored.p_WF, MIRROR * step.p_WF, atol=1e-9)
    # A half turn has no side: it may saturate to either.
    if abs(abs(wrap_angle(commanded.yaw - stance.yaw)) - math.pi) > 1e-6:
        assert wrap_angle(mirrored.yaw + step.yaw) == pytest.approx(0.0, abs=1e-9)


@given(
    forward=st.floats(-LIMITS.backward, LIMITS.forward),
    width=st.floats(LIMITS.width.least, LIMITS.width.greatest),
    rise=st.floats(-LIMITS.rise, LIMITS.rise),
    turn=st.floats(-LIMITS.toe_in, LIMITS.toe_out),
    yaw=YAWS,
    foot=st.sampled_from([LEFT, RIGHT]),
)
def test_a_step_within_reach_is_taken_as_it_is(forward, width, rise, turn, yaw, foot):
    sign = outward(foot)
    stance = FootPose(np.array([0.3, -0.2, 0.1]), rotation_z(yaw))
    commanded = Footstep(
        index=3,
        foot=foot,
        p_WF=stance.p_WF + rotation_z(yaw) @ [forward, sign * width, rise],
        yaw=stance.yaw + sign * turn,
        duration=0.5 * (LIMITS.duration.least + LIMITS.duration.greatest),
        swing_height=0.5 * (LIMITS.swing_height.least + LIMITS.swing_height.greatest),
    )
    assert_same(saturate(commanded, stance, LIMITS), commanded)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("ahead", [0.4, -0.3])
def test_a_wide_step_leads_less_far(foot, ahead):
    limits = dataclasses.replace(LIMITS, reach=0.5)
    stance = FootPose(np.array([0.3, -0.2, 0.1]), rotation_z(0.4))
    for width, taken in ((0.2, ahead), (0.45, math.copysign(0.218, ahead))):
        place = [ahead, outward(foot) * width, 0.0]
        step = Footstep(1, foot, stance.p_WF + stance.R_WF @ place, 0.4, 1.0, 0.1)
        found = in_stance_frame(saturate(step, stance, limits), stance)
        assert found[:2] == pytest.approx((taken, width), abs=1e-3)
    # A step for balance may lead farther, as it may be wider.
    assert limits.extended(0.1).reach == pytest.approx(0.6)


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.5])
@pytest.mark.parametrize(("tilt", "kept"), [(0.1, 0.1), (0.2, 0.2), (0.5, 0.2)])
def test_the_ground_is_tilted_within_limits(heading, tilt, kept):
    aside = np.array([math.cos(heading), math.sin(heading)])
    normal = np.append(math.sin(tilt) * aside, math.cos(tilt))
    stance = FootPose(np.zeros(3), rotation_z(0.3))
    step = Footstep(1, LEFT, np.array([0.1, 0.2, 0.0]), 0.3, 1.0, 0.1, normal)
    limits = dataclasses.replace(LIMITS, tilt=0.2)
    taken = saturate(step, stance, limits)
    expected = np.append(math.sin(kept) * aside, math.cos(kept))
    np.testing.assert_allclose(taken.normal, expected, atol=1e-12)
    np.testing.assert_allclose(taken.pose.R_WF[:, 2], expected, atol=1e-12)
    assert taken.pose.yaw == pytest.approx(0.3)
