"""Hands go along lines and stay where they are told, with their loads."""

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.tree import SpatialInertia

from atlas_drake import (
    AtlasSimulation,
    HandGoal,
    HandMotion,
    InvalidMessageError,
    reach,
)
from atlas_drake.units import GRAVITY

PALM = (0.0, 0.1, 0.005)
PLACE = np.array([0.35, 0.35, 1.1])
BAG = 5.0
"""[kg]"""


def bag(plant):
    """Hangs a bag on the left hand."""
    model = plant.AddModelInstance("bag")
    inertia = SpatialInertia.SolidSphereWithMass(BAG, 0.1)
    body = plant.AddRigidBody("bag", model, inertia)
    hand = plant.GetFrameByName("l_hand")
    plant.WeldFrames(hand, body.body_frame(), RigidTransform(PALM))


def palm(sim):
    context = sim.plant.GetMyContextFromRoot(sim.context)
    X_WH = sim.plant.GetFrameByName("l_hand").CalcPoseInWorld(context)
    return X_WH @ np.array(sim.robot.palms["l_hand"])


def hold(sim, hands, seconds):
    """Yields the palm's place after each command."""
    end = sim.time + seconds
    while sim.time < end - 1e-9:
        sim.publish(hands.command(sim.time, sim.output("state")))
        sim.advance(hands.PERIOD)
        yield palm(sim)


def goal(force=0.0):
    return HandGoal("l_hand", PLACE, force=(0.0, 0.0, force))


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, BAG])
def test_a_hand_gets_there_on_a_line_and_does_not_sag(load):
    sim = AtlasSimulation(world=[bag] if load else [])
    hands, start = HandMotion(sim.robot), palm(sim)
    hands.aim(sim.time, sim.output("state"), [goal(load * GRAVITY)], 1.0)
    way = np.array(list(hold(sim, hands, 2.0)))
    np.testing.assert_allclose(way[-1], PLACE, atol=0.005)
    along = (PLACE - start) / np.linalg.norm(PLACE - start)
    off = (way - start) - np.outer((way - start) @ along, along)
    assert np.linalg.norm(off, axis=1).max() < 0.03
    others = ~sim.robot.limb("l_arm")
    assert not np.array(sim.atlas_state.k_effort)[others].any()
    assert not sim.has_fallen


@pytest.mark.slow
def test_a_palm_gives_way_as_softly_as_it_was_told():
    """In its softest direction, which is some direction in space, by force over K."""
    sim, stiffness, force = AtlasSimulation(), 400.0, 8.0
    hands = HandMotion(sim.robot)
    # A push is at the hand's origin.
    soft = HandGoal("l_hand", PLACE, palm=[0.0, 1e-3, 0.0], stiffness=stiffness)
    hands.aim(sim.time, sim.output("state"), [soft], 1.0)
    *_, before = hold(sim, hands, 2.0)
    moved = []
    for axis in np.eye(3):
        sim.apply_push("l_hand", force * axis, 1.0)
        *_, pushed = hold(sim, hands, 1.0)
        *_, after = hold(sim, hands, 1.0)
        np.testing.assert_allclose(after, before, atol=2e-3)
        moved.append((pushed - before) / force)
    compliance = np.array(moved)
    softest = np.linalg.eigvalsh(compliance + compliance.T).max() / 2.0
    assert softest == pytest.approx(1.0 / stiffness, rel=0.1)


@pytest.mark.slow
def test_stiffness_changes_without_a_jump_and_has_its_range():
    sim = AtlasSimulation()
    hands, arm = HandMotion(sim.robot), sim.robot.limb("l_arm")
    gains = []
    for stiffness in (None, 300.0, None):
        there = HandGoal("l_hand", PLACE, stiffness=stiffness)
        hands.aim(sim.time, sim.output("state"), [there], 0.5)
        for _ in hold(sim, hands, 0.6):
            gains.append(np.array(sim.atlas_state.kp_position)[arm][0])
    assert np.abs(np.diff(gains[1:])).max() < 0.15 * max(gains)
    assert min(gains) < 0.5 * gains[-1]
    for wrong in (0.0, -5.0, float("nan"), "soft", 1e9):
        with pytest.raises(InvalidMessageError, match="stiffness"):
            HandGoal("l_hand", PLACE, stiffness=wrong)


@pytest.mark.slow
def test_a_hand_that_is_carried_stays_at_the_chest():
    sim = AtlasSimulation()
    hands = HandMotion(sim.robot)
    hands.aim(sim.time, sim.output("state"), [goal()], 0.5)
    list(hold(sim, hands, 0.6))
    (carried,) = hands.carried(sim.time, sim.output("state"))
    assert carried.frame == "trunk"
    X_WT = sim.frame_pose(sim.robot.trunk)
    np.testing.assert_allclose(X_WT @ np.array(carried.position), PLACE, atol=1e-6)


@pytest.mark.slow
def test_what_is_out_of_reach_leaves_the_motion_before_in_force():
    sim = AtlasSimulation()
    hands = HandMotion(sim.robot)
    hands.aim(sim.time, sim.output("state"), [goal()], 0.5)
    far = HandGoal("l_hand", [3.0, 0.0, 1.0])
    with pytest.raises(InvalidMessageError, match="nearest"):
        hands.aim(sim.time, sim.output("state"), [far], 0.5)
    assert not hands.is_there(sim.time)
    *_, last = hold(sim, hands, 1.0)
    np.testing.assert_allclose(last, PLACE, atol=0.01)


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), "soon"])
def test_a_duration_that_is_none_is_refused(duration):
    sim = AtlasSimulation()
    hands = HandMotion(sim.robot)
    with pytest.raises(InvalidMessageError, match="duration"):
        hands.aim(sim.time, sim.output("state"), [goal()], duration)


@pytest.mark.slow
def test_jolts_of_the_trunk_do_not_throw_a_stretched_arm_about():
    """Where a millimetre of the palm would cost a tenth of a radian of the elbow."""
    sim = AtlasSimulation()
    state, robot = sim.output("state").copy(), sim.robot
    hand = HandGoal("l_hand", [2.0, 0.6, 0.4], frame="pelvis")
    [farthest] = reach(robot, state, [hand]).positions
    hands, joints = HandMotion(robot), []
    stretched = HandGoal("l_hand", 0.998 * farthest, frame="pelvis")
    hands.aim(0.0, state, [stretched], 0.1)
    back = (
        robot.plant.num_positions() + robot.indices(robot.plant).v[robot.limb("back")]
    )
    for tick in range(90):
        state[back] = 0.3 * (-1.0) ** tick  # [rad/s]
        joints.append(hands.command(0.1 + tick * hands.PERIOD, state).position)
    assert np.abs(np.diff(joints[60:], axis=0)).max() < 0.03
