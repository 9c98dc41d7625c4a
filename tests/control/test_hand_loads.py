"""What the hands carry: estimated, counted, and part of the model."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.tree import SpatialInertia

from atlas_drake import (
    AtlasSimulation,
    HandGoal,
    HandMotion,
    HandWork,
    Scenario,
    reach,
)
from atlas_drake.clients.campaigns.shipped import landing
from atlas_drake.control.whole_body.hand_loads import HandLoads
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.units import GRAVITY

DT = 0.009


def wrenches(left=(0.0, 0.0, 0.0), right=(0.0, 0.0, 0.0)):
    """Wrenches of forces at the origins of the hands."""
    return np.array([[0.0, 0.0, 0.0, *left], [0.0, 0.0, 0.0, *right]])


def after(seconds, felt, before=None):
    now = wrenches() if before is None else before
    for _ in range(round(seconds / DT)):
        now = HandLoads().follow(now, felt, DT)
    return now


def test_a_load_counts_once_it_stays_and_a_bump_does_not():
    rules = HandLoads()
    carried = rules.carried(after(2.0, wrenches([0.0, 0.0, -98.1])))
    np.testing.assert_allclose(carried, [10.0, 0.0], atol=0.01)
    bump = after(DT, wrenches([0.0, 0.0, -50.0]))
    assert not rules.carried(bump).any()
    assert not after(3.0, wrenches(), before=bump).any()


def test_a_table_that_the_hands_lean_on_is_no_load():
    leaning = after(2.0, wrenches([0.0, 0.0, 200.0], [0.0, 0.0, 50.0]))
    assert not HandLoads().carried(leaning).any()


def test_the_news_are_told_once():
    rules = HandLoads()
    heavy, light = wrenches([0.0, 0.0, -49.0], [0.0, 0.0, -59.0]), wrenches()
    right = wrenches(right=[0.0, 0.0, -59.0])
    assert rules.news(right, heavy) == ["the left hand takes up a load"]
    assert rules.news(heavy, right) == ["the left hand is empty again"]
    assert rules.news(light, light) == []


def test_the_model_has_what_pulls_at_the_hands_beside_their_loads():
    """Its generalized force is virtual work: J^T of the hand, without the load's."""
    sim = AtlasSimulation()
    model, state = WholeBodyModel(sim.robot), sim.output("state")
    context, loads = model.create_context(), np.array([5.0, 0.0])
    felt = wrenches([20.0, -30.0, -5.0 * GRAVITY], [0.0, 40.0, 0.0])
    loaded = model.evaluate(context, state, loads)
    pulled = model.evaluate(context, state, loads, felt)
    hands = [pulled.frame(name) for name in ("l_hand", "r_hand")]
    at = model.plant.GetBodyByName("l_hand").default_com()
    arm = hands[0].R_WF @ at
    felt[0] += [*np.cross(arm, [0.0, 0.0, 5.0 * GRAVITY]), 0.0, 0.0, 5.0 * GRAVITY]
    work = sum(hand.J_WF.T @ wrench for hand, wrench in zip(hands, felt, strict=True))
    np.testing.assert_allclose(loaded.h - pulled.h, work, atol=1e-9)
    np.testing.assert_allclose(pulled.pull[3:], [20.0, 10.0, 0.0], atol=1e-9)
    moment = sum(
        wrench[:3] + np.cross(hand.p_WF, wrench[3:])
        for hand, wrench in zip(hands, felt, strict=True)
    )
    np.testing.assert_allclose(pulled.pull[:3], moment, atol=1e-9)
    assert not loaded.pull.any()
    assert not loaded.pull_offset.any()


@pytest.mark.slow
def test_a_robot_that_presses_against_a_wall_stays_upright():
    """The wall's force is part of the model: the CoP moves, the robot does not."""
    wall = {"size": [0.1, 1.0, 2.0], "position": [0.57, 0.0, 2.0]}
    sim, height = AtlasSimulation(Scenario(terrain=[wall])), 1.05
    hands = HandMotion(sim.robot)

    def press(ahead, force, seconds):
        goals = [
            HandGoal(
                hand,
                [ahead, side * 0.25, height],
                [1.0, 0.0, 0.0],
                [force, 0.0, 0.0],
                stiffness=400.0,
            )
            for hand, side in (("l_hand", 1.0), ("r_hand", -1.0))
        ]
        hands.aim(sim.time, sim.output("state"), goals, 1.0)
        end = sim.time + seconds
        while sim.time < end:
            sim.publish(hands.command(sim.time, sim.output("state")))
            sim.advance(hands.PERIOD)
        return sim.record

    free, pressed = press(0.38, 0.0, 1.5), press(0.41, 32.0, 4.6)
    force = pressed.hands.left_force[0] + pressed.hands.right_force[0]
    assert force < -70.0
    np.testing.assert_allclose(pressed.balance.com, free.balance.com, atol=0.003)
    shift = pressed.balance.cop[0] - free.balance.cop[0]
    tipping = force * height / (sim.robot.mass * GRAVITY)
    assert shift == pytest.approx(tipping, rel=0.15)


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


def hang(plant):
    """Hangs a bag of 10 kg on the left hand."""
    bag = plant.AddModelInstance("bag")
    body = plant.AddRigidBody("bag", bag, SpatialInertia.SolidSphereWithMass(10.0, 0.1))
    hand = plant.GetFrameByName("l_hand")
    plant.WeldFrames(hand, body.body_frame(), RigidTransform([0.0, 0.1, 0.0]))


@pytest.mark.slow
def test_feet_land_where_they_are_told_with_a_bag_in_one_hand():
    sim = AtlasSimulation(world=[hang])
    sim.advance(3.0)
    HandWork(sim).walk_to(0.8, 0.4, 0.5)
    assert not sim.has_fallen
    assert landing(sim)["landing_max_m"] < 0.005


@pytest.mark.slow
def test_a_bag_on_a_hand_is_felt_and_leaves_the_robot_upright():
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


@pytest.mark.slow
def test_a_hand_on_the_own_hip_is_no_pull():
    sim = AtlasSimulation()
    hands, state = HandMotion(sim.robot), sim.output("state")
    hip = HandGoal("l_hand", [0.0, 0.24, 0.0], frame="pelvis")
    # The arm keeps clear of the hip; a force presses the hand onto it.
    beside = reach(sim.robot, state, [hip]).positions[0]
    inward = [0.0, -100.0, 0.0]
    hands.aim(sim.time, state, [replace(hip, position=beside, force=inward)], 1.0)
    hand, touched = sim.plant.GetBodyByName("l_hand").index(), False
    while sim.time < 2.0:
        sim.publish(hands.command(sim.time, sim.output("state")))
        sim.advance(hands.PERIOD)
        results = sim.output("contact_results")
        pairs = map(
            results.point_pair_contact_info, range(results.num_point_pair_contacts())
        )
        touched |= any(hand in (one.bodyA_index(), one.bodyB_index()) for one in pairs)
        assert not sim.output("hand_wrenches").any()
    assert touched
