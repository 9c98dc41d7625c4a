"""Steering to a waypoint: the velocity that leads there."""

import math

import pytest
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake import AtlasSimulation, Behavior, Gait, walk_to
from atlas_drake.planning.waypoints import (
    NEAR,
    NEAR_YAW,
    velocity_to,
    waypoint_error,
)


def pelvis(x, y, yaw):
    return RigidTransform(RotationMatrix.MakeZRotation(yaw), [x, y, 0.9])


def test_the_error_is_as_the_pelvis_sees_it():
    error = waypoint_error(pelvis(1.0, 2.0, math.pi / 2), (0.5, 4.0), -math.pi)
    assert error == pytest.approx((2.0, 0.5, math.pi / 2))


def test_a_near_waypoint_is_approached_slowly_and_a_far_one_at_the_limit():
    here, gait = pelvis(0.0, 0.0, 0.0), Gait()
    near = velocity_to(here, (0.2, 0.0), 0.0, gait, fastest=0.4)
    far = velocity_to(here, (9.0, 0.0), 0.0, gait, fastest=0.4)
    assert near == pytest.approx((0.3, 0.0, 0.0))
    assert far == pytest.approx((0.4, 0.0, 0.0))


def test_a_heading_alone_is_a_turn_and_none_is_asked_for_there():
    gait = Gait()
    turned = velocity_to(pelvis(0.0, 0.0, 0.3), (0.0, 0.0), 0.0, gait)
    assert turned.forward == 0.0
    assert turned.turn == pytest.approx(-0.45)
    assert velocity_to(pelvis(0.0, 0.0, 0.05), (0.05, 0.0), 0.0, gait) is None


@pytest.mark.slow
def test_a_robot_is_led_to_a_place_and_stands_there():
    sim, place, heading = AtlasSimulation(), (0.4, 0.3), 0.5
    gait = sim.scenario.controller_config().gait()
    while sim.time < 8.0:
        report = sim.atlas_sim_interface_state
        sim.publish(walk_to(report, sim.pelvis_pose, place, heading, gait))
        sim.advance(0.1)
    assert sim.current_behavior is Behavior.STAND
    ahead, left, turn = waypoint_error(sim.pelvis_pose, place, heading)
    # The last steps, which close the feet, lead a little further.
    assert math.hypot(ahead, left) < 1.5 * NEAR
    assert abs(turn) < 1.5 * NEAR_YAW
