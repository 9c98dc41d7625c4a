"""Directions become footsteps: pure geometry, no simulation."""

import math
from itertools import pairwise

import pytest

from atlas_drake.behaviors.step_queue import footstep_from
from atlas_drake.cockpit.steering import (
    Direction,
    begin_walk,
    close_feet,
    first_open_step,
    is_closing,
    next_steps,
)
from atlas_drake.control.feet.footstep import LEFT, RIGHT, FootPose, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.control.rotations import rotation_z
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior
from atlas_drake.planning.footholds import Gait, foothold

GAIT = Gait()
DIRECTIONS = {
    "forward": Direction(forward=1.0),
    "backward": Direction(forward=-1.0),
    "arc left": Direction(forward=1.0, turn=1.0),
    "arc right": Direction(forward=1.0, turn=-1.0),
    "left": Direction(left=1.0),
    "right": Direction(left=-1.0),
    "turn left": Direction(turn=1.0),
    "turn right": Direction(turn=-1.0),
    "on the spot": Direction(),
}


def walk(report, step, in_air):
    """The report while a step is in the air, or once it has landed."""
    report.current_behavior = Behavior.WALK
    feedback = report.walk_feedback
    feedback.current_step_index = step.step_index
    if in_air:
        feedback.step_queue_saturated[0] = step
    else:
        report.foot_pos_est[step.foot_index] = step.pose
        feedback.step_queue_saturated[0] = type(step)()
    return report


def follow(report, direction, count=9, gait=GAIT):
    """Takes ``count`` steps exactly as told, with news while each is in the air."""
    walker, steps = next_steps(begin_walk(direction), direction, gait, report)
    taken = []
    for _ in range(count):
        taken.append(steps[0])
        walk(report, steps[0], in_air=True)
        walker, steps = next_steps(walker, direction, gait, report)
        walk(report, taken[-1], in_air=False)
    return taken


def middle(report):
    left, right = (foothold(pose) for pose in report.foot_pos_est)
    return 0.5 * (left.x + right.x), 0.5 * (left.y + right.y), left.yaw


def test_forward_is_a_stride_per_step(standing):
    taken = follow(standing, DIRECTIONS["forward"])
    assert [step.step_index for step in taken] == list(range(1, 10))
    assert [step.foot_index for step in taken[:4]] == [0, 1, 0, 1]
    x = [step.pose.position.x for step in taken]
    gains = [b - a for a, b in pairwise(x)]
    assert x[0] == pytest.approx(GAIT.stride_change)
    assert gains == pytest.approx([GAIT.stride] * 8)
    assert {abs(step.pose.position.y) for step in taken} == {GAIT.half_width}


def test_backward_is_the_other_way_and_slower(standing):
    taken = follow(standing, DIRECTIONS["backward"])
    assert -9 * GAIT.stride < taken[-1].pose.position.x < -0.5


@pytest.mark.parametrize(("name", "sign"), [("left", 1.0), ("right", -1.0)])
def test_sideways_begins_with_the_foot_on_that_side(standing, name, sign):
    taken = follow(standing, DIRECTIONS[name], count=8)
    assert taken[0].foot_index == (LEFT if sign > 0 else RIGHT)
    x, y, yaw = middle(standing)
    assert (x, yaw) == pytest.approx((0.0, 0.0))
    assert y == pytest.approx(sign * 4 * 0.5 * GAIT.stride)


@pytest.mark.parametrize(("name", "sign"), [("turn left", 1.0), ("turn right", -1.0)])
def test_turning_stays_on_the_spot(standing, name, sign):
    follow(standing, DIRECTIONS[name], count=8)
    x, y, _ = middle(standing)
    assert math.hypot(x, y) < 0.02
    assert foothold(standing.foot_pos_est[0]).yaw == pytest.approx(
        sign * 7.5 * GAIT.turn, abs=GAIT.turn
    )


@pytest.mark.parametrize(("name", "sign"), [("arc left", 1.0), ("arc right", -1.0)])
def test_arcs_curve_to_their_side(standing, name, sign):
    follow(standing, DIRECTIONS[name])
    x, y, yaw = middle(standing)
    assert x > 0.5
    assert sign * y > 0.3
    assert sign * yaw > 1.0


@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS)
@pytest.mark.parametrize(
    "gait", [GAIT, Gait(stride=0.3, turn=0.25, duration=1.2, swing_height=0.25)]
)
def test_no_step_has_to_be_saturated(standing, direction, gait):
    feet = [foothold(pose) for pose in standing.foot_pos_est]
    for data in follow(standing, direction, gait=gait):
        x, y, yaw = feet[1 - data.foot_index]
        stance = FootPose(footstep_from(data).p_WF * 0.0, rotation_z(yaw))
        stance.p_WF[:2] = x, y
        step = footstep_from(data)
        taken = saturate(step, stance, StepLimits())
        assert taken.p_WF == pytest.approx(step.p_WF, abs=1e-9)
        assert math.cos(taken.yaw - step.yaw) == pytest.approx(1.0, abs=1e-12)
        assert taken.duration == step.duration
        feet[data.foot_index] = foothold(data.pose)


def test_a_step_that_has_begun_no_longer_changes(standing):
    assert first_open_step(standing) == 1
    walker, steps = next_steps(begin_walk(Direction()), Direction(), GAIT, standing)
    assert [step.step_index for step in steps] == [1, 2, 3, 4]
    # In the air: the next step may change. On the ground: the weight moves for it.
    assert first_open_step(walk(standing, steps[0], in_air=True)) == 2
    walk(standing, steps[0], in_air=False)
    standing.walk_feedback.step_queue_saturated[0] = steps[1]
    assert first_open_step(standing) == 3
    walker, steps = next_steps(walker, Direction(1.0), GAIT, standing)
    assert steps[0].step_index == 3
    assert steps[0].foot_index == LEFT


def test_a_step_lands_beside_where_the_one_before_is_reported_to_land(standing):
    _, steps = next_steps(begin_walk(Direction()), Direction(), GAIT, standing)
    steps[0].pose.position.x = 0.3  # Balance has moved it.
    walk(standing, steps[0], in_air=True)
    _, steps = next_steps(begin_walk(Direction()), Direction(), GAIT, standing)
    assert steps[0].pose.position.x == pytest.approx(0.3)


def test_a_change_of_direction_goes_through_shorter_strides(standing):
    forward, back = DIRECTIONS["forward"], DIRECTIONS["backward"]
    walker, steps = next_steps(begin_walk(forward), forward, GAIT, standing)
    walk(standing, steps[1], in_air=True)
    standing.foot_pos_est[0] = steps[0].pose
    _, steps = next_steps(walker, back, GAIT, standing)
    x = [2 * GAIT.stride, *(step.pose.position.x for step in steps)]
    changes = [b - a for a, b in pairwise(x)]
    assert changes[0] == pytest.approx(GAIT.stride - GAIT.stride_change)
    assert changes[-1] == pytest.approx(-GAIT.backward_stride)


def test_stopping_puts_the_feet_side_by_side(standing):
    forward = DIRECTIONS["forward"]
    walker, steps = next_steps(begin_walk(forward), forward, GAIT, standing)
    walk(standing, steps[0], in_air=True)
    walker = close_feet(walker, GAIT, standing)
    assert walker.closing == 2
    assert not is_closing(walker, standing)
    walker, closing = next_steps(walker, forward, GAIT, standing)
    assert closing[0].pose.position.x == steps[0].pose.position.x
    walk(standing, steps[0], in_air=False)
    walk(standing, closing[0], in_air=True)
    assert is_closing(walker, standing)
    assert not is_closing(replace(walker, closing=None), standing)


def test_a_fast_walk_stops_by_shorter_strides(standing):
    forward = DIRECTIONS["forward"]
    gait = replace(GAIT, stride=0.35, stride_change=0.1)
    walker = begin_walk(forward)
    for _ in range(4):
        walker, steps = next_steps(walker, forward, gait, standing)
        walk(standing, steps[0], in_air=True)
    walker, steps = next_steps(walker, forward, gait, standing)
    place = standing.walk_feedback.step_queue_saturated[0].pose.position.x
    walker = close_feet(walker, gait, standing)
    _, steps = next_steps(walker, Direction(), gait, standing)
    assert walker.closing == steps[3].step_index
    x = [place, *(step.pose.position.x for step in steps)]
    assert [b - a for a, b in pairwise(x)] == pytest.approx([0.25, 0.15, 0.05, 0.0])
