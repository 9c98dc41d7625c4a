"""Velocities become footsteps: geometry, and a robot that walks by them."""

import math
from itertools import pairwise

import numpy as np
import pytest
from pydrake.math import RollPitchYaw

from atlas_drake import (
    AtlasSimulation,
    Behavior,
    Gait,
    Scenario,
    stop_walking,
    walk_at,
)
from atlas_drake.control.feet.footstep import saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import replace
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS, AtlasBehaviorStepData
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, footstep_from
from atlas_drake.planning.footholds import (
    Foothold,
    foothold,
    sole_beside,
    step_data,
)
from atlas_drake.planning.walk_at import first_open_step
from atlas_drake.rotations import rotation_z
from atlas_drake.scenario import Jitter

GAIT = Gait()
AHEAD = GAIT.stride / GAIT.duration
ASIDE, TURN = 0.25 * AHEAD, GAIT.turn / GAIT.duration
VELOCITIES = {
    "forward": (AHEAD, 0.0, 0.0),
    "backward": (-0.7 * AHEAD, 0.0, 0.0),
    "arc left": (AHEAD, 0.0, TURN),
    "arc right": (AHEAD, 0.0, -TURN),
    "left": (0.0, ASIDE, 0.0),
    "right": (0.0, -ASIDE, 0.0),
    "turn left": (0.0, 0.0, TURN),
    "turn right": (0.0, 0.0, -TURN),
    "on the spot": (0.0, 0.0, 0.0),
    # Feet near each other make room for a wider side step; only a foot that turns
    # outward turns so far.
    "fast to the left": (0.0, 0.24, 0.0),
    "fast turn right": (0.0, 0.0, -0.58),
}


def walking(report, steps, in_air=True):
    """The report while the first of some steps is in the air, or once it has landed."""
    report.current_behavior = report.desired_behavior = Behavior.WALK
    feedback = report.walk_feedback
    feedback.current_step_index = steps[0].step_index
    if not in_air:
        report.foot_pos_est[steps[0].foot_index] = steps[0].pose
    known = [*steps[0 if in_air else 1 :], *[AtlasBehaviorStepData()] * 4]
    feedback.step_queue_saturated = known[:NUM_REQUIRED_WALK_STEPS]
    return report


def steps_of(command):
    return command.walk_params.step_queue


def follow(report, velocity, count=9, gait=GAIT):
    """Takes ``count`` steps exactly as told, with news while each is in the air."""
    steps = steps_of(walk_at(report, *velocity, gait))
    taken = []
    for _ in range(count):
        taken.append(steps[0])
        walking(report, steps[:1])
        steps = steps_of(walk_at(report, *velocity, gait))
        walking(report, [taken[-1], *steps], in_air=False)
    return taken


def middle(report):
    left, right = (foothold(pose) for pose in report.foot_pos_est)
    return 0.5 * (left.x + right.x), 0.5 * (left.y + right.y), left.yaw


def test_forward_is_a_stride_per_step(standing):
    taken = follow(standing, VELOCITIES["forward"])
    assert [step.step_index for step in taken] == list(range(1, 10))
    assert [step.foot_index for step in taken[:4]] == [0, 1, 0, 1]
    x = [step.pose.position.x for step in taken]
    gains = [b - a for a, b in pairwise(x)]
    assert x[0] == pytest.approx(GAIT.stride_change)
    assert gains == pytest.approx([GAIT.stride] * 8)
    assert {abs(step.pose.position.y) for step in taken} == {GAIT.half_width}


@pytest.mark.parametrize(("name", "sign"), [("left", 1.0), ("right", -1.0)])
def test_sideways_begins_with_the_foot_on_that_side(standing, name, sign):
    taken = follow(standing, VELOCITIES[name], count=8)
    assert taken[0].foot_index == (LEFT if sign > 0 else RIGHT)
    x, y, yaw = middle(standing)
    assert (x, yaw) == pytest.approx((0.0, 0.0))
    assert y == pytest.approx(sign * 4 * 0.5 * GAIT.stride)


@pytest.mark.parametrize("velocity", VELOCITIES.values(), ids=VELOCITIES)
@pytest.mark.parametrize(
    "gait", [GAIT, Gait(duration=1.2, swing_height=0.25), Gait(stride_change=0.05)]
)
def test_no_step_has_to_be_saturated(standing, velocity, gait):
    feet = [foothold(pose) for pose in standing.foot_pos_est]
    for data in follow(standing, velocity, gait=gait):
        x, y, yaw = feet[1 - data.foot_index]
        stance = FootPose(footstep_from(data).p_WF * 0.0, rotation_z(yaw))
        stance.p_WF[:2] = x, y
        step = footstep_from(data)
        taken = saturate(step, stance, StepLimits())
        assert taken.p_WF == pytest.approx(step.p_WF, abs=1e-9)
        assert math.cos(taken.yaw - step.yaw) == pytest.approx(1.0, abs=1e-12)
        assert taken.duration == pytest.approx(step.duration)
        feet[data.foot_index] = foothold(data.pose)


@pytest.mark.parametrize(
    ("speed", "duration", "stride"),
    [
        (0.4, 0.63, 0.252),
        (0.64, 0.63, 0.4032),
        (0.67, 0.4076 / 0.67, 0.4076),
        (9, 0.6, 0.4076),
    ],
)
def test_longer_strides_come_first_then_quicker_steps(
    standing, speed, duration, stride
):
    gait = Gait(stride_change=1.0)
    steps = follow(standing, (speed, 0.0, 0.0), 3, gait)
    assert steps[2].duration == pytest.approx(duration, rel=1e-3)
    gained = steps[2].pose.position.x - steps[1].pose.position.x
    assert gained == pytest.approx(stride, rel=1e-3)


def test_a_step_that_has_begun_no_longer_changes(standing):
    assert first_open_step(standing) == 1
    steps = steps_of(walk_at(standing))
    assert [step.step_index for step in steps] == [1, 2, 3, 4]
    # In the air: the next step may change. On the ground: the weight moves for it.
    assert first_open_step(walking(standing, steps)) == 2
    assert first_open_step(walking(standing, steps, in_air=False)) == 3
    steps = steps_of(walk_at(standing, AHEAD))
    assert steps[0].step_index == 3
    assert steps[0].foot_index == LEFT


def test_what_the_robot_already_does_is_not_sent_again(standing):
    turning = walk_at(standing, turn=TURN)
    assert turning.walk_params.use_relative_step_height
    assert walk_at(walking(standing, steps_of(turning)), turn=TURN) is None
    standing.current_behavior = Behavior.STAND
    steps = steps_of(walk_at(standing, AHEAD))
    assert walk_at(walking(standing, steps), AHEAD) is None
    assert walk_at(standing, AHEAD, turn=0.1) is not None
    steps[0].pose.position.x += 0.05  # Balance has moved it.
    assert walk_at(standing, AHEAD) is not None


def test_a_change_of_velocity_goes_through_shorter_strides(standing):
    gait = replace(GAIT, stride_change=0.1)
    taken = follow(standing, (AHEAD, 0.0, 0.0), 5, gait)
    coming = standing.walk_feedback.step_queue_saturated[0]
    steps = steps_of(walk_at(standing, -AHEAD, gait=gait))
    x = [step.pose.position.x for step in (taken[-1], coming, *steps)]
    changes = [b - a for a, b in pairwise(x)]
    assert changes == pytest.approx([0.2, 0.1, 0.0, -0.1, -0.2])


def test_another_behavior_gives_way_to_stand_first(standing):
    standing.current_behavior = standing.desired_behavior = Behavior.MANIPULATE
    assert walk_at(standing, AHEAD).behavior == Behavior.STAND
    standing.desired_behavior = Behavior.STAND
    assert walk_at(standing, AHEAD) is None
    assert stop_walking(standing) is None


def test_a_walk_stops_by_shorter_strides_with_the_feet_side_by_side(standing):
    gait = replace(GAIT, stride=0.35, stride_change=0.1)
    taken = follow(standing, (0.35 / gait.duration, 0.0, 0.0), 6, gait)
    walking(standing, [taken[-1]])
    steps = steps_of(stop_walking(standing, gait))
    x = [taken[-1].pose.position.x, *(step.pose.position.x for step in steps)]
    gains = [b - a for a, b in pairwise(x)]
    assert gains == pytest.approx([0.25, 0.15, 0.05, 0.0])
    for step, after in pairwise(steps):
        walking(standing, [step, after], in_air=False)
    assert stop_walking(standing, gait).behavior == Behavior.WALK
    walking(standing, [steps[-1]])
    assert stop_walking(standing, gait).behavior == Behavior.STAND


@pytest.mark.parametrize(("yaw", "stops"), [(0.6, True), (0.5, False)])
def test_a_turned_walk_stops_once_the_step_in_the_air_closes_it(standing, yaw, stops):
    middle = Foothold(0.0, 0.0, 0.6)
    left, right = (sole_beside(middle, foot, GAIT) for foot in (LEFT, RIGHT))
    standing.foot_pos_est[LEFT] = step_data(1, LEFT, left, GAIT).pose
    walking(standing, [step_data(2, RIGHT, right._replace(yaw=yaw), GAIT)])
    asked = stop_walking(standing).behavior
    assert asked == (Behavior.STAND if stops else Behavior.WALK)


def test_the_fastest_side_steps_make_the_speed(standing):
    steps = follow(standing, VELOCITIES["fast to the left"], 8)
    way = middle(standing)[1]
    assert way / sum(step.duration for step in steps) == pytest.approx(0.24, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("left", "turn"), [(0.45, 0.0), (0.0, -1.0)], ids=["aside", "on the spot"]
)
def test_a_robot_goes_as_fast_as_asked(left, turn):
    sim = AtlasSimulation(Scenario(seed=3, jitter=Jitter(mass=0.05)))
    gait = sim.scenario.controller_config().gait()
    places = []
    while sim.time < 7.0:
        sim.publish(walk_at(sim.atlas_sim_interface_state, 0.0, left, turn, gait))
        sim.advance(0.1)
        yaw = RollPitchYaw(sim.pelvis_pose.rotation()).yaw_angle()
        places.append((*sim.pelvis_pose.translation()[:2], yaw))
    x, y, yaw = np.unwrap(places[30:], axis=0).T
    assert (yaw[-1] - yaw[0]) / 3.9 == pytest.approx(turn, abs=0.05)
    speed = math.hypot(x[-1] - x[0], y[-1] - y[0]) / 3.9
    assert speed == pytest.approx(left, abs=0.035)
    assert max(step["error_m"] for step in sim.footsteps) < 0.01


@pytest.mark.slow
def test_a_robot_walks_at_a_velocity_turns_and_stops():
    sim = AtlasSimulation()
    gait = sim.scenario.controller_config().gait()
    places, sent = [], 0
    while sim.current_behavior != Behavior.STAND or sim.time < 6.0:
        report = sim.atlas_sim_interface_state
        if sim.time < 4.0:
            command = walk_at(report, 0.4, gait=gait)
        elif sim.time < 6.0:
            command = walk_at(report, 0.2, turn=0.2, gait=gait)
        else:
            command = stop_walking(report, gait)
        sim.publish(command)
        sent += command is not None
        sim.advance(0.1)
        places.append(sim.pelvis_pose.translation()[0])
    assert (places[39] - places[20]) / 1.9 == pytest.approx(0.4, abs=0.02)
    assert not sim.has_fallen
    # A command for each step, as each needs one more to follow; few besides.
    assert sent < 1.3 * len(sim.footsteps)
    left, right = map(foothold, sim.atlas_sim_interface_state.foot_pos_est)
    assert left.yaw == pytest.approx(right.yaw, abs=0.02)
    assert left.yaw > 0.3
    apart = math.hypot(left.x - right.x, left.y - right.y)
    assert apart == pytest.approx(gait.stance_width, abs=0.01)
