"""Planned footsteps: they end at the goal, and the robot can take each of them."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from atlas_drake import (
    AtlasSimInterfaceState,
    Behavior,
    Gait,
    Quaternion,
    StepStream,
    Vector3,
    steps_ahead,
    steps_along_arc,
    steps_to,
    steps_turning,
)
from atlas_drake.control.feet.footstep import limit_duration, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages import WalkStatus
from atlas_drake.messages.footstep import LEFT, FootPose, footstep_from
from atlas_drake.rotations import mean_yaw, rotation_z, wrap_angle

LIMITS = StepLimits()
HALF_WIDTH = Gait().half_width
PLACES = st.floats(-4.0, 4.0)
ANGLES = st.floats(-math.pi, math.pi)
FASTEST = Gait(stride=0.35, turn=0.25, duration=1.42)
"""Everything at its limit."""


def report_of(left, right, z=0.0):
    """A report of a robot whose soles are at (x, y, yaw)."""
    report = AtlasSimInterfaceState()
    report.current_behavior = Behavior.STAND
    for pose, (x, y, yaw) in zip(report.foot_pos_est, (left, right), strict=True):
        pose.position = Vector3(x, y, z)
        pose.orientation = Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
    return report


def standing(x=0.0, y=0.0, yaw=0.0, width=2 * HALF_WIDTH, z=0.0):
    """A report of a robot with its feet side by side about (x, y)."""
    c, s = math.cos(yaw), math.sin(yaw)
    soles = [(x - s * w, y + c * w, yaw) for w in (0.5 * width, -0.5 * width)]
    return report_of(*soles, z=z)


@st.composite
def gaits(draw):
    """Any gait that can be asked for."""
    stride = draw(st.floats(0.01, 0.35))
    turn = draw(st.floats(0.01, 0.25))
    duration = draw(st.floats(0.6, 1.42))
    return Gait(stride=stride, turn=turn, duration=duration)


@st.composite
def reports(draw):
    """A robot anywhere, its feet as after any step, side by side or not."""
    yaw, z = draw(ANGLES), draw(st.floats(-1.0, 1.0))
    R_WS = rotation_z(yaw)
    p_WS = np.array([draw(PLACES), draw(PLACES), z])
    p_SL = [draw(st.floats(-0.3, 0.4)), draw(st.floats(0.18, 0.4)), 0.0]
    turn = draw(st.floats(-0.25, 0.5))
    p_WL = p_WS + R_WS @ p_SL
    return report_of((*p_WL[:2], yaw + turn), (*p_WS[:2], yaw), z=z)


def soles(report):
    return [
        FootPose(
            pose.position.to_array(),
            rotation_z(2.0 * math.atan2(pose.orientation.z, pose.orientation.w)),
        )
        for pose in report.foot_pos_est
    ]


def middle(feet):
    x, y = 0.5 * (feet[0].p_WF[:2] + feet[1].p_WF[:2])
    return x, y, mean_yaw(feet[0].yaw, feet[1].yaw)


def taken(report, steps):
    """The soles after the steps; each of them is one that the robot can take."""
    feet = soles(report)
    assert [data.step_index for data in steps] == [*range(1, len(steps) + 1)]
    assert all(a.foot_index != b.foot_index for a, b in pairwise(steps))
    for data in steps:
        step = footstep_from(data)
        stance = feet[1 - step.foot]
        done = saturate(step, stance, LIMITS)
        done = limit_duration(done, feet[step.foot], stance, LIMITS)
        np.testing.assert_allclose(done.p_WF, step.p_WF, atol=1e-9)
        assert wrap_angle(done.yaw - step.yaw) == pytest.approx(0.0, abs=1e-9)
        assert done.duration == pytest.approx(step.duration)
        assert done.swing_height == pytest.approx(step.swing_height)
        feet[step.foot] = step.pose
    return feet


def assert_ends_at(feet, x, y, yaw):
    """Feet side by side about this place."""
    here = middle(feet)
    np.testing.assert_allclose(here[:2], (x, y), atol=1e-3)
    assert wrap_angle(here[2] - yaw) == pytest.approx(0.0, abs=1e-3)
    apart = rotation_z(yaw).T @ (feet[0].p_WF - feet[1].p_WF)
    np.testing.assert_allclose(apart, [0.0, 2 * HALF_WIDTH, 0.0], atol=1e-3)
    assert wrap_angle(feet[0].yaw - feet[1].yaw) == pytest.approx(0.0, abs=1e-3)


@settings(deadline=None, max_examples=25)
@given(report=reports(), x=PLACES, y=PLACES, yaw=ANGLES)
def test_from_any_feet_to_any_pose(report, x, y, yaw):
    steps = steps_to(report, x, y, yaw)
    assert_ends_at(taken(report, steps), x, y, yaw)
    here = middle(soles(report))
    distance = math.dist(here[:2], (x, y))
    # No more steps than for turning twice and walking, by strides or sideways.
    assert len(steps) <= distance / 0.04 + 2 * math.pi / 0.15 + 12


@settings(deadline=None, max_examples=50)
@given(
    report=reports(),
    gait=st.one_of(st.just(Gait()), st.just(FASTEST), gaits()),
    x=st.floats(-0.5, 0.5),
    y=st.floats(-0.5, 0.5),
    turn=st.floats(-1.0, 1.0),
)
@example(standing(), FASTEST, 0.5, 0.1, 0.6)
@example(standing(), FASTEST, 0.5, 0.3, -0.6)
def test_to_a_pose_nearby_in_any_gait(report, gait, x, y, turn):
    # Ahead, aside and turning at once.
    here = middle(soles(report))
    goal = here[0] + x, here[1] + y, here[2] + turn
    steps = steps_to(report, *goal, gait)
    # Only the first one begins with feet as far apart as they happen to be.
    assert {step.duration for step in steps[1:]} <= {gait.duration}
    assert {step.swing_height for step in steps} <= {gait.swing_height}
    # None where the feet are side by side in the right place, if not exactly.
    if steps:
        assert_ends_at(taken(report, steps), *goal)


@settings(deadline=None, max_examples=25)
@given(
    report=reports(),
    gait=st.one_of(st.just(FASTEST), gaits()),
    length=st.floats(-3.0, 3.0),
    angle=st.floats(-7.0, 7.0),
)
def test_along_an_arc(report, gait, length, angle):
    x, y, yaw = middle(soles(report))
    steps = steps_along_arc(report, length, angle, gait)
    chord = length * np.sinc(0.5 * angle / math.pi)
    x += chord * math.cos(yaw + 0.5 * angle)
    y += chord * math.sin(yaw + 0.5 * angle)
    if steps:
        assert_ends_at(taken(report, steps), x, y, yaw + angle)
    else:
        assert max(abs(length), abs(angle)) < 1e-5


def strides(steps):
    """Distances ahead from one footprint to the next, of a walk along x."""
    x = [0.0, *(step.pose.position.x for step in steps)]
    return [b - a for a, b in pairwise(x)]


@pytest.mark.parametrize("distance", [3.0, -3.0])
def test_a_walk_gains_and_loses_its_speed_step_by_step(distance):
    gait = Gait(stride=0.3, stride_change=0.08)
    steps = steps_ahead(standing(), distance, gait)
    assert steps[0].foot_index == LEFT
    taken_strides = strides(steps)
    longest = gait.stride if distance > 0.0 else gait.backward_stride
    assert sum(taken_strides) == pytest.approx(distance)
    assert max(map(abs, taken_strides)) == pytest.approx(longest, rel=0.1)
    changes = np.diff([0.0, *taken_strides])
    assert np.abs(changes).max() <= gait.stride_change + 1e-9


def test_a_speed_is_a_stride_at_the_usual_pace_or_the_longest_one_quicker():
    usual = Gait()
    assert usual.at_speed(0.3) == replace(usual, stride=0.3 * usual.duration)
    fast = usual.at_speed(0.5 * usual.longest_stride * (1 / 0.63 + 1 / 0.6))
    assert fast.stride == pytest.approx(usual.longest_stride)
    assert 0.6 < fast.duration < usual.duration
    steps = steps_ahead(standing(), 4.0, speed=0.5)
    middle_steps = strides(steps)[3:-4]
    assert {step.duration for step in steps} == {usual.duration}
    assert np.mean(middle_steps) == pytest.approx(0.5 * usual.duration, rel=0.1)
    taken(standing(), steps)


@pytest.mark.parametrize(
    ("length", "angle", "speed"), [(5.0, 6.28, 0.3), (8, -3.1, 0.5)]
)
def test_a_bend_is_walked_as_fast_as_asked_or_not_at_all(length, angle, speed):
    steps = steps_along_arc(standing(), length, angle, speed=speed)
    taken(standing(), steps)
    # Between the steps that gain and lose speed, middle to middle of the feet.
    places = np.array([footstep_from(step).p_WF[:2] for step in steps])[3:-3]
    middles = 0.5 * (places[1:] + places[:-1])
    way = np.linalg.norm(np.diff(middles, axis=0), axis=1).mean()
    assert way / steps[3].duration == pytest.approx(speed, rel=0.05)
    with pytest.raises(ValueError, match=r"at most \d\.\d\d with a radius of"):
        steps_along_arc(standing(), length, angle, speed=0.65)


def test_a_speed_backward_and_a_rate_of_turning():
    back = steps_ahead(standing(), -4.0, speed=0.4)
    pace = min(strides(back)) / back[0].duration
    assert pace == pytest.approx(-0.4, rel=0.1)
    turning = steps_turning(standing(), 2.0, rate=0.35)
    assert footstep_from(turning[0]).yaw / turning[0].duration == pytest.approx(
        0.35, rel=0.1
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_fast_turn_is_taken_by_the_outward_foot(sign):
    gait = Gait()
    rate = gait.sharpest_turn / gait.limits.duration.least
    steps = steps_turning(standing(), sign * 2.0, rate=rate)
    assert_ends_at(taken(standing(), steps), 0.0, 0.0, sign * 2.0)
    turns = -sign * np.diff([0.0, *(footstep_from(step).yaw for step in steps)])
    outward, inward = turns[:-2:2], turns[1:-2:2]
    np.testing.assert_allclose(-inward, gait.limits.toe_in, atol=0.03)
    assert -outward[0] > gait.limits.toe_in + 0.1
    assert max(-outward) <= gait.limits.toe_out


@pytest.mark.parametrize("width", [0.2, 0.23, 0.26])
def test_feet_a_little_nearer_or_wider_need_no_step_more(width):
    assert len(steps_ahead(standing(width=width), 1.0)) == 6


@pytest.mark.parametrize("angle", [math.pi / 2, -math.pi / 2, math.pi, 5.0, -5.0])
def test_a_turn_goes_its_way_round_on_the_spot(angle):
    report = standing(1.0, -1.0, 0.4)
    steps = steps_turning(report, angle)
    # With the foot on that side first.
    assert steps[0].foot_index == (0 if angle > 0.0 else 1)
    yaws = [0.4]
    for step in steps:
        yaws.append(footstep_from(step).yaw)
    turns = [wrap_angle(b - a) for a, b in pairwise(yaws)]
    assert sum(turns) == pytest.approx(angle)
    assert all(turn * angle >= -1e-9 for turn in turns)
    assert_ends_at(taken(report, steps), 1.0, -1.0, 0.4 + angle)


def test_no_way_to_go_is_no_step():
    report = standing(1.0, 2.0, 0.5)
    assert steps_ahead(report, 0.0) == steps_turning(report, 0.0) == []
    assert steps_to(report, 1.0, 2.0, 0.5) == []


def test_feet_apart_are_put_side_by_side_even_where_they_are():
    report = report_of((0.3, 0.12, 0.0), (0.0, -0.12, 0.0))
    assert_ends_at(taken(report, steps_ahead(report, 0.0)), 0.15, 0.0, 0.0)


def test_feet_far_apart_leave_the_first_step_less_time():
    report = report_of((0.3, 0.25, 0.0), (0.0, -0.25, 0.0))
    steps = steps_ahead(report, 1.0, Gait(duration=2.5))
    taken(report, steps)
    assert steps[0].duration < 2.0
    assert {step.duration for step in steps[1:]} == {2.5}


def test_a_long_stride_leaves_a_step_less_time():
    assert Gait(duration=3.0).duration == 3.0
    with pytest.raises(ValueError, match=r"gait\.duration is 3\.0.* 1\.49"):
        Gait(stride=0.35, duration=3.0)


def test_steps_are_level_with_the_feet():
    steps = steps_ahead(standing(z=0.35), 0.5)
    assert {step.pose.position.z for step in steps} == {0.35}
    report = standing()
    report.foot_pos_est[0].position.z = 0.1
    with pytest.raises(ValueError, match=r"0\.100 m"):
        steps_ahead(report, 1.0)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: steps_ahead(standing(), math.nan), "distance"),
        (lambda: steps_ahead(standing(), -(10**5000)), "distance"),
        (lambda: steps_along_arc(standing(), 1001.0, 0.0), "length"),
        (lambda: steps_turning(standing(), 10**400), "angle"),
        (lambda: steps_to(standing(), 1e7, 0.0, 0.0), "x"),
        (lambda: steps_to(standing(), 0.0, 0.0, 1e9), "yaw"),
        (lambda: steps_to(standing(), 1.0, math.nan, 0.0), "y"),
        (lambda: steps_ahead(standing(), 1.0, speed=3.0), "speed"),
        (lambda: steps_ahead(standing(), 1.0, speed=-0.1), "speed"),
        (lambda: steps_to(standing(), 1.0, 0.0, 0.0, speed=math.nan), "speed"),
        (lambda: steps_turning(standing(), 1.0, rate=9.0), "rate"),
        (lambda: Gait(stride=0.5), "gait.stride"),
        (lambda: Gait(turn=0.4), "gait.turn"),
        (lambda: Gait(duration=0.1), "gait.duration"),
        (lambda: Gait(swing_height=math.nan), "gait.swing_height"),
    ],
)
def test_values_out_of_range_are_named(call, name):
    with pytest.raises(ValueError, match=rf"^{name} is "):
        call()


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_report_without_a_place_for_a_foot_is_an_error(value):
    report = standing()
    report.foot_pos_est[1].position.z = value
    for call in (lambda: steps_ahead(report, 1.0), lambda: steps_to(report, 1, 0, 0)):
        with pytest.raises(ValueError, match=r"^foot_pos_est\[1\].position.z is "):
            call()


def walking(needed, current, time=1.0, behavior=Behavior.WALK):
    report = standing()
    report.header.stamp = time
    report.current_behavior = behavior
    if behavior != Behavior.STAND:
        report.walk_feedback.status_flags = WalkStatus.SUBSTATE_STEPPING
    report.walk_feedback.next_step_index_needed = needed
    report.walk_feedback.current_step_index = current
    return report


def indices(command):
    queue = command.walk_params.step_queue
    return [step.step_index for step in queue if step.step_index > 0]


def test_a_stream_sends_four_at_a_time_when_they_are_needed():
    stream = StepStream(steps_ahead(standing(), 1.5))
    still = walking(1, 0, 0.0, Behavior.STAND)
    assert not stream.is_over(still)
    first = stream.next_command(still)
    assert first.behavior == Behavior.WALK
    assert indices(first) == [1, 2, 3, 4]
    # Until the robot has read them, nothing more is known of it.
    assert stream.next_command(still) is None
    assert not stream.is_over(still)
    assert stream.next_command(walking(5, 1)) is None
    assert indices(stream.next_command(walking(5, 2))) == [5, 6, 7, 8]
    assert stream.next_command(walking(5, 2)) is None
    assert indices(stream.next_command(walking(9, 6))) == [9]
    assert stream.next_command(walking(10, 9)) is None
    assert not stream.is_over(walking(10, 9, 8.0))
    assert stream.is_over(walking(1, 0, 9.0, Behavior.STAND))


def test_a_stream_goes_on_in_a_behavior_derived_from_walk():
    own = Behavior.named(160, "MY_WALK")
    stream = StepStream(steps_ahead(standing(), 1.5))
    stream.next_command(walking(1, 0, 0.0, Behavior.STAND))
    assert not stream.is_over(walking(5, 2, 1.0, own))
    assert indices(stream.next_command(walking(5, 2, 1.0, own))) == [5, 6, 7, 8]


def test_a_stream_ends_with_a_walk_that_ends_early_or_never_begins():
    stream = StepStream(steps_ahead(standing(), 3.0))
    stream.next_command(walking(1, 0, 0.0, Behavior.STAND))
    later = walking(1, 0, 1.0, Behavior.STAND)
    assert stream.is_over(later)
    assert stream.next_command(later) is None
    assert StepStream([]).is_over(later)
    assert StepStream([]).next_command(later) is None
