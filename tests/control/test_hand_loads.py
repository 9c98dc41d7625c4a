"""What the hands carry: estimated, counted, and part of the model."""

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.tree import SpatialInertia

from atlas_drake import AtlasSimulation
from atlas_drake.control.whole_body.hand_loads import HandLoads
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.units import GRAVITY

DT = 0.009


def after(seconds, force, loads=(0.0, 0.0), rules=None):
    loads = np.array(loads)
    for _ in range(round(seconds / DT)):
        loads = (rules or HandLoads()).follow(loads, np.array(force), DT)
    return loads


def test_a_load_counts_once_it_stays_and_a_bump_does_not():
    rules = HandLoads()
    np.testing.assert_allclose(after(2.0, [-98.1, 0.0]), [10.0, 0.0], atol=0.01)
    bump = after(DT, [-50.0, 0.0])
    assert not rules.counted(bump).any()
    assert not after(3.0, [0.0, 0.0], loads=[10.0, 10.0]).any()


def test_a_table_that_the_hands_lean_on_is_no_load():
    assert not after(2.0, [200.0, 50.0]).any()


def test_the_news_are_told_once():
    rules = HandLoads()
    assert rules.news(np.array([0.0, 6.0]), np.array([5.0, 6.0])) == [
        "the left hand takes up a load"
    ]
    assert rules.news(np.array([5.0, 6.0]), np.array([5.0, 0.0])) == [
        "the right hand is empty again"
    ]


def test_the_model_has_the_loads_and_loses_them_again():
    sim = AtlasSimulation()
    robot, model = sim.robot, WholeBodyModel(sim.robot)
    context, state = model.create_context(), sim.output("state")
    empty = model.evaluate(context, state)
    loaded = model.evaluate(context, state, np.array([5.0, 0.0]))
    assert loaded.mass == pytest.approx(robot.mass + 5.0)
    assert loaded.M[5, 5] == pytest.approx(loaded.mass)
    hand = model.plant.GetBodyByName("l_hand")
    at = hand.EvalPoseInWorld(context) @ hand.default_spatial_inertia().get_com()
    com = (robot.mass * empty.com + 5.0 * at) / loaded.mass
    np.testing.assert_allclose(loaded.com, com, atol=1e-9)
    again = model.evaluate(context, state)
    np.testing.assert_array_equal(again.M, empty.M)


def test_a_bag_on_a_hand_is_felt_and_leaves_the_robot_upright():
    def hang(plant):
        bag = plant.AddModelInstance("bag")
        body = plant.AddRigidBody(
            "bag", bag, SpatialInertia.SolidSphereWithMass(10.0, 0.1)
        )
        hand = plant.GetFrameByName("l_hand")
        plant.WeldFrames(hand, body.body_frame(), RigidTransform([0.0, 0.1, 0.0]))

    sim = AtlasSimulation(world=[hang])
    sim.advance(2.0)
    left, right = sim.output("hand_wrenches").reshape(2, 6)
    np.testing.assert_allclose(left[3:], [0.0, 0.0, -10.0 * GRAVITY], atol=1e-9)
    assert not right.any()
    assert [one.text for one in sim.events if one.kind == "load"] == [
        "the left hand takes up a load"
    ]
    # The feet share robot and bag alike: the robot has moved its weight aside.
    loads = sim.output("foot_wrenches")[[5, 11]]
    assert loads.sum() == pytest.approx((sim.robot.mass + 10.0) * GRAVITY, rel=0.01)
    assert loads[0] == pytest.approx(loads[1], rel=0.1)
