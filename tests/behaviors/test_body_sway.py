"""Pelvis and arms swing with the feet of a walk."""

import numpy as np
import pytest

from atlas_drake.behaviors.body_sway import arm_swing


def hand_places(robot, joints):
    """Places of both hands in the pelvis' frame [m]."""
    plant = robot.plant
    context = plant.CreateDefaultContext()
    q = plant.GetPositions(context)
    q[robot.indices(plant).q] = joints
    plant.SetPositions(context, q)
    pelvis = plant.GetFrameByName(robot.file.pelvis)
    return [
        plant.GetFrameByName(hand).CalcPose(context, pelvis).translation()
        for hand in robot.file.hands
    ]


def test_each_hand_goes_ahead_with_the_other_foot(robot):
    lead, arms = 0.02, 0.3
    swing = arm_swing(robot, arms)
    before = hand_places(robot, robot.stand_prep)
    after = hand_places(robot, robot.stand_prep + lead * swing)
    left, right = (b - a for a, b in zip(before, after, strict=True))
    assert right[0] == pytest.approx(arms * lead, rel=0.02)
    assert left[0] == pytest.approx(-arms * lead, rel=0.02)
    # Only the arms move.
    assert not swing[~robot.limb("l_arm", "r_arm")].any()
    np.testing.assert_array_equal(arm_swing(robot, 0.0), 0.0)
