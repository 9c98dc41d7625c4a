"""The height of the body within the legs' reach, against Drake's kinematics."""

import numpy as np
import pytest

from atlas_drake.control.feet.leg_kinematics import (
    highest_com,
    highest_sole,
    hips_from_com,
    knee_ahead,
    knee_for_length,
    leg_length,
    lowest_com,
)
from atlas_drake.messages.footstep import FootPose


def feet(terms):
    return [FootPose(foot.p_WF, foot.R_WF) for foot in terms.feet]


@pytest.mark.parametrize("knee", [0.2, 0.5, 1.2, 2.0])
def test_leg_length_is_the_robots(model, knee):
    legs, plant = model.robot.legs, model.plant
    context = model.create_context()
    plant.GetJointByName("l_leg_kny").set_angle(context, knee)
    hip, ankle = (
        plant.EvalBodyPoseInWorld(context, plant.GetJointByName(name).child_body())
        for name in ("l_leg_hpy", "l_leg_aky")
    )
    length = np.linalg.norm(hip.translation() - ankle.translation())
    assert leg_length(legs[0], knee) == pytest.approx(length)
    assert knee_for_length(legs[0], length) == pytest.approx(knee)


def test_the_highest_body_has_a_leg_all_but_straight(model, standing):
    legs = model.robot.legs
    hips, com = hips_from_com(standing, legs), standing.com[:2]
    left, right = feet(standing)
    high = highest_com(legs, hips, com, [(0, left), (1, right)])
    assert high > standing.com[2]
    ankle = left.p_WF + left.R_WF @ legs[0].p_FA
    hip = np.append(com, high) + hips[0]
    longest = leg_length(legs[0], legs[0].straight + legs[0].least_flexion)
    assert np.linalg.norm(hip - ankle) == pytest.approx(longest)
    # A foothold lower down, or farther off, brings the body down.
    lower = FootPose(left.p_WF - np.array([0.0, 0.0, 0.1]), left.R_WF)
    both = [(0, lower), (1, right)]
    assert highest_com(legs, hips, com, both) == pytest.approx(high - 0.1)
    away = FootPose(left.p_WF + np.array([0.3, 0.0, 0.0]), left.R_WF)
    assert highest_com(legs, hips, com, [(0, away), (1, right)]) < high - 0.02


def test_the_lowest_body_is_where_the_knee_reaches_its_lever(model, standing):
    legs = model.robot.legs
    hips = hips_from_com(standing, legs)
    pose = feet(standing)[0]
    com = pose.p_WF[:2]
    heights = [
        lowest_com(legs, hips, com, 0, pose, lever, 0.4) for lever in (0.10, 0.15)
    ]
    assert heights[1] < heights[0] - 0.01
    # With the weight farther ahead the same knee may bend more.
    ahead = lowest_com(legs, hips, com + np.array([0.04, 0.0]), 0, pose, 0.10, 0.4)
    assert ahead < heights[0]


@pytest.mark.parametrize("lean", [-0.3, 0.0, 0.3])
def test_a_bent_knee_is_as_far_ahead_as_the_robots(model, lean):
    robot, plant, legs = model.robot, model.plant, model.robot.legs
    angles = robot.stand_prep.copy()
    for name, angle in (("hpy", -0.5 + lean), ("kny", 1.1), ("aky", -0.6 - lean)):
        angles[robot.joint_index(f"l_leg_{name}")] = angle
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(plant).q] = angles
    context = model.create_context()
    terms = model.evaluate(context, state)
    body = plant.GetJointByName("l_leg_kny").child_body()
    knee = plant.EvalBodyPoseInWorld(context, body).translation()
    hips = hips_from_com(terms, legs)
    found = knee_ahead(legs[0], hips[0], terms.com, feet(terms)[0])
    # But for the hip pitch joint's own small swing about the roll joint.
    assert found == pytest.approx(knee[0] - terms.com[0], abs=0.01)


def test_a_leg_lifts_its_sole_as_far_as_it_folds(model, standing):
    legs = model.robot.legs
    hips = hips_from_com(standing, legs)
    height = float(standing.com[2])
    top = highest_sole(legs, hips, height, 0)
    # From hip to ankle, with the sole level and straight below the hip.
    left = height + hips[0, 2] - (top + legs[0].p_FA[2])
    assert left == pytest.approx(
        leg_length(legs[0], legs[0].straight + legs[0].most_flexion)
    )
    assert 0.2 < top < 0.4
    assert highest_sole(legs, hips, height - 0.1, 0) == pytest.approx(top - 0.1)
