"""Hands and walks one after the other: each act ends when it is done."""

import numpy as np

from atlas_drake import AtlasSimulation, Behavior, HandGoal, HandWork

PALM = (0.0, 0.1, 0.005)


def test_a_hand_points_where_it_is_told_and_keeps_its_place_on_a_walk():
    sim = AtlasSimulation()
    work = HandWork(sim)
    there = np.array([0.35, 0.3, 1.05])
    aside = np.array([0.8, 0.6, 0.0])
    work.move([HandGoal("l_hand", there, PALM, (0.0, 1.0, 0.0), aside)], 1.5)

    def palm():
        return sim.frame_pose("l_hand") @ np.array(PALM)

    points = sim.frame_pose("l_hand").rotation().matrix()[:, 1]
    np.testing.assert_allclose(palm(), there, atol=0.005)
    assert np.degrees(np.arccos(points @ aside)) < 1.0
    work.hold()
    at_pelvis = sim.pelvis_pose.inverse() @ palm()
    off = []
    sim.hooks.append(lambda sim: off.append(sim.pelvis_pose.inverse() @ palm()))
    work.walk_to(0.6, 0.0, 0.0)
    assert sim.current_behavior is Behavior.STAND
    assert np.linalg.norm(np.array(off) - at_pelvis, axis=1).max() < 0.03


def test_hands_without_a_goal_are_the_behaviors():
    sim = AtlasSimulation()
    work = HandWork(sim)
    work.hold()
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05], PALM)], 0.5)
    assert sim.output("commands").joints.k_effort.any()
    work.move([], 0.5)
    assert not sim.output("commands").joints.k_effort.any()


def test_an_act_ends_when_the_robot_falls():
    sim = AtlasSimulation()
    work = HandWork(sim)
    sim.apply_push("trunk", [3000.0, 0.0, 0.0], 0.2)
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05], PALM)], 30.0)
    assert sim.has_fallen
    assert sim.time < 10.0
