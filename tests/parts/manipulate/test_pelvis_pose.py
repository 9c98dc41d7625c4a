"""Pelvis poses relative to the feet: definition of the numbers, and their motion."""

import dataclasses

import numpy as np
import pytest
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake.messages.footstep import FootPose
from atlas_drake.parts.manipulate.pelvis_pose import (
    PelvisLead,
    PelvisMotion,
    PelvisPose,
    PelvisRates,
    at_rest,
    make_stance,
)
from atlas_drake.robot.soles import sole_corners
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import SupportPolygon

DT = 0.002
RATES, LEAD = PelvisRates(), PelvisLead()


def stand(left, right):
    """A stance on two soles given as x, y, z and yaw."""
    feet = [FootPose(np.array(p[:3]), rotation_z(p[3])) for p in (left, right)]
    corners = [sole_corners(foot.p_WF, foot.R_WF, 0.1, 0.05) for foot in feet]
    return make_stance(*feet, SupportPolygon(np.concatenate(corners)))


SIDE_BY_SIDE = ((0.0, 0.1, 0.0, 0.0), (0.0, -0.1, 0.0, 0.0))
TURNED = ((2.9, 5.0, 0.3, 1.7), (3.1, 5.0, 0.3, 1.5))
"""Facing the world's y."""


def motion_at(stance, pose):
    return PelvisMotion(
        height=at_rest(np.array([stance.middle[2] + pose.height])),
        turn=at_rest(np.array([stance.yaw + pose.yaw, pose.pitch, pose.roll])),
        com=at_rest(stance.com(pose)),
    )


def test_offsets_are_to_the_left_foot_and_forward():
    com = stand(*SIDE_BY_SIDE).com(PelvisPose(0.8, com_v0=0.03, com_v1=0.05))
    np.testing.assert_allclose(com, [0.05, 0.03])


def test_angles_are_roll_pitch_yaw_about_the_feets_heading():
    R = stand(*TURNED).R_WP(PelvisPose(0.8, yaw=0.1, pitch=0.2, roll=-0.3))
    expected = RotationMatrix(RollPitchYaw(-0.3, 0.2, 1.6 + 0.1)).matrix()
    np.testing.assert_allclose(R, expected, atol=1e-12)


def test_the_measured_pose_is_that_of_the_terms(standing):
    feet = [FootPose(foot.p_WF, foot.R_WF) for foot in standing.feet]
    corners = [sole_corners(foot.p_WF, foot.R_WF, 0.1, 0.05) for foot in feet]
    stance = make_stance(*feet, SupportPolygon(np.concatenate(corners)))
    pose = stance.measure(standing)
    assert pose.height == pytest.approx(standing.p_WP[2])
    np.testing.assert_allclose([pose.yaw, pose.pitch, pose.roll], 0.0, atol=1e-12)
    np.testing.assert_allclose(stance.com(pose), standing.com[:2], atol=1e-12)
    tilted = RotationMatrix(RollPitchYaw(-0.3, 0.2, 0.1)).matrix()
    pose = stance.measure(dataclasses.replace(standing, R_WP=tilted))
    np.testing.assert_allclose([pose.roll, pose.pitch, pose.yaw], [-0.3, 0.2, 0.1])


@pytest.mark.parametrize("soles", [SIDE_BY_SIDE, TURNED])
def test_the_reference_goes_to_the_goal(soles):
    stance = stand(*soles)
    goal = PelvisPose(0.75, 0.2, -0.1, 0.15, 0.02, -0.03)
    motion = motion_at(stance, PelvisPose(0.9))
    for _ in range(round(4.0 / DT)):
        motion = motion.towards(goal, stance, RATES, DT)
    np.testing.assert_allclose(motion.pose(stance), goal, atol=1e-3)


def test_yaw_takes_the_short_way_round():
    stance = stand((0.1, 0.0, 0.0, 3.1), (-0.1, 0.0, 0.0, 3.1))
    motion = motion_at(stance, PelvisPose(0.9))
    motion = motion.towards(PelvisPose(0.9, yaw=0.2), stance, RATES, DT)
    assert 0.0 < motion.turn.velocity[0] < RATES.turn.speed


def test_a_slip_of_the_feet_moves_the_goal_and_not_the_reference():
    before = stand(*SIDE_BY_SIDE)
    after = stand((0.02, 0.1, 0.0, 0.0), (0.02, -0.1, 0.0, 0.0))
    motion = motion_at(before, PelvisPose(0.9))
    assert motion.pose(after).com_v1 == pytest.approx(-0.02)


def test_the_reference_waits_for_a_robot_that_does_not_follow(standing):
    feet = [FootPose(foot.p_WF, foot.R_WF) for foot in standing.feet]
    corners = [sole_corners(foot.p_WF, foot.R_WF, 0.1, 0.05) for foot in feet]
    stance = make_stance(*feet, SupportPolygon(np.concatenate(corners)))
    measured = stance.measure(standing)
    motion = motion_at(stance, measured)
    assert motion.held_near(standing, LEAD) == motion
    goal = measured._replace(height=0.6, yaw=0.6, com_v1=measured.com_v1 + 0.1)
    for _ in range(round(3.0 / DT)):
        motion = motion.towards(goal, stance, RATES, DT).held_near(standing, LEAD)
    pose = motion.pose(stance)
    assert pose.height == pytest.approx(measured.height - LEAD.height)
    assert pose.yaw == pytest.approx(LEAD.turn)
    # Balance gives way to nothing.
    assert pose.com_v1 == pytest.approx(goal.com_v1, abs=1e-3)
