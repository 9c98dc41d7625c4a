"""Pelvis and arms swing with the feet of a walk."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.behaviors.body_sway import LEAST_LEVER, arm_swing


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


def test_a_stretched_arm_does_not_swing_wildly(robot):
    """Ahead of a hand that is straight ahead of its shoulder there is nowhere to go."""
    random = np.random.default_rng(0)
    most, short = 1.0 / (LEAST_LEVER * robot.com_height), 0
    for _ in range(60):
        pose = random.uniform(robot.position_lower, robot.position_upper)
        joints = [
            dataclasses.replace(joint, stand_prep=float(angle))
            for joint, angle in zip(robot.file.joints, pose, strict=True)
        ]
        file = dataclasses.replace(robot.file, joints=joints)
        swing = arm_swing(dataclasses.replace(robot, file=file), 1.0)
        for limb in ("l_arm", "r_arm"):
            size = np.linalg.norm(swing[robot.limb(limb)])
            assert size <= most
            short += size > 0.8 * most
    assert short > 0
