"""Hands and walks one after the other: each act ends when it is done."""

import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake import (
    AtlasSimulation,
    Behavior,
    HandGoal,
    HandWork,
    InvalidMessageError,
    Scenario,
)


def palm(sim, frame="world"):
    """Where the left palm is and where the hand points, in the frame of a body."""
    palm = np.array(sim.robot.palms["l_hand"])
    X_FH = sim.frame_pose(frame).inverse() @ sim.frame_pose("l_hand")
    return X_FH @ palm, X_FH.rotation() @ palm


def degrees_between(one, other):
    cosine = one @ other / (np.linalg.norm(one) * np.linalg.norm(other))
    return np.degrees(np.arccos(min(cosine, 1.0)))


@pytest.mark.slow
def test_a_hand_points_where_it_is_told():
    sim = AtlasSimulation()
    there, aside = np.array([0.35, 0.3, 1.05]), np.array([0.8, 0.6, 0.0])
    HandWork(sim).move([HandGoal("l_hand", there, aside)], 1.5)
    place, axis = palm(sim)
    np.testing.assert_allclose(place, there, atol=0.005)
    assert degrees_between(axis, aside) < 1.0


@pytest.mark.slow
def test_a_goal_at_a_thing_is_where_the_thing_is():
    sim = AtlasSimulation(Scenario(world="box"))
    X_WB = RigidTransform(RotationMatrix.MakeZRotation(0.4), [0.8, 0.4, 0.45])
    context, box = sim.part("plant")[1], sim.plant.GetBodyByName("box")
    sim.plant.SetFreeBodyPose(context, box, X_WB)
    work, before = HandWork(sim), [-0.45, 0.0, 0.5]
    work.move([HandGoal("l_hand", before, [1.0, 0.0, 0.0], frame="box")], 1.5)
    place, axis = palm(sim)
    np.testing.assert_allclose(place, X_WB @ before, atol=0.005)
    assert degrees_between(axis, X_WB.rotation().matrix()[:, 0]) < 1.0
    with pytest.raises(InvalidMessageError, match="there is no frame 'bocks'"):
        work.move([HandGoal("l_hand", before, frame="bocks")], 1.0)


def test_a_goal_in_the_world_is_turned_as_its_frame_is():
    X_WF = RigidTransform(RotationMatrix.MakeYRotation(0.5), [1.0, 2.0, 3.0])
    wxyz = RotationMatrix.MakeXRotation(0.3).ToQuaternion().wxyz()
    force = [0.0, 0.0, 10.0]
    goal = HandGoal("l_hand", [0.1, 0.0, 0.0], None, force, "box", wxyz)
    seen = goal.in_world(X_WF)
    assert seen.frame == "world"
    np.testing.assert_allclose(seen.force, X_WF.rotation() @ force)
    there = X_WF.rotation() @ goal.rotation
    np.testing.assert_allclose(there.matrix(), seen.rotation.matrix(), atol=1e-12)


@pytest.mark.slow
def test_a_hand_keeps_its_goal_at_the_pelvis_on_a_walk():
    sim = AtlasSimulation()
    work = HandWork(sim)
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05])], 1.0)
    there, axis = palm(sim, "pelvis")
    work.move([HandGoal("l_hand", there, axis, frame="pelvis")], 0.3)
    off, turned = [], []

    def look(sim):
        place, now = palm(sim, "pelvis")
        off.append(np.linalg.norm(place - there))
        turned.append(degrees_between(now, axis))

    sim.hooks.append(look)
    work.walk_to(0.6, 0.0, 0.0)
    assert sim.current_behavior is Behavior.STAND
    assert max(off) < 0.015
    assert max(turned) < 2.0


@pytest.mark.slow
def test_hands_that_are_held_stay_at_the_chest_on_a_walk():
    sim = AtlasSimulation()
    work = HandWork(sim)
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05])], 1.0)
    work.hold()
    there, off = palm(sim, sim.robot.trunk)[0], []
    sim.hooks.append(lambda sim: off.append(palm(sim, sim.robot.trunk)[0] - there))
    work.walk_to(0.6, 0.0, 0.0)
    assert np.linalg.norm(off, axis=1).max() < 0.015


@pytest.mark.slow
@pytest.mark.parametrize("place", [[0.4, 0.2, 0.4], [0.7, 0.2, 1.0], [0.4, 0.5, 0.5]])
def test_the_whole_body_brings_a_hand_where_its_arm_does_not_reach(place):
    sim = AtlasSimulation()
    sim.advance(1.0)
    work, goals = HandWork(sim), [HandGoal("l_hand", place)]
    with pytest.raises(InvalidMessageError, match="cannot reach it"):
        work.move(goals, 2.0)
    work.bend(goals)
    work.move(goals, 3.0)
    np.testing.assert_allclose(palm(sim)[0], place, atol=0.005)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert not sim.footsteps


@pytest.mark.slow
def test_what_the_whole_body_does_not_reach_is_refused_and_nothing_moves():
    sim = AtlasSimulation()
    with pytest.raises(InvalidMessageError, match=r"cannot reach it, .* the nearest"):
        HandWork(sim).bend([HandGoal("l_hand", [0.3, 0.3, 0.1])])
    sim.advance(0.1)
    assert sim.current_behavior is Behavior.STAND


@pytest.mark.slow
def test_hands_without_a_goal_are_the_behaviors():
    sim = AtlasSimulation()
    work = HandWork(sim)
    work.hold()
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05])], 0.5)
    assert sim.output("commands").joints.k_effort.any()
    work.move([], 0.5)
    assert not sim.output("commands").joints.k_effort.any()


@pytest.mark.slow
def test_an_act_ends_when_the_robot_falls():
    sim = AtlasSimulation()
    work = HandWork(sim)
    sim.apply_push("trunk", [3000.0, 0.0, 0.0], 0.2)
    work.move([HandGoal("l_hand", [0.35, 0.3, 1.05])], 30.0)
    assert sim.has_fallen
    assert sim.time < 10.0
