"""Joints under user control, whole or shared: behaviors balance with the others."""

import sys
from pathlib import Path

import numpy as np
import pytest

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
)
from atlas_drake.simulation.tutorial import KP_POSITION

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from hand_over import GOAL, hand_overs


def joints_of(sim, *parts):
    """Joints whose names hold one of these, bool, shape (n,)."""
    names = sim.robot.joint_names
    return np.array([any(part in name for part in parts) for name in names])


def speed(sim, joints=slice(None)):
    """Of the fastest of some joints [rad/s]."""
    return np.abs(np.array(sim.atlas_state.velocity)[joints]).max()


def warnings(sim):
    return [event.text for event in sim.events if event.kind == "warning"]


def robot_in(behavior):
    """A robot that has been in a behavior for a moment."""
    sim = AtlasSimulation()
    sim.publish(AtlasSimInterfaceCommand(behavior=behavior))
    sim.advance(0.3)
    return sim


@pytest.mark.parametrize(
    ("joints", "named"),
    [(("l_leg_akx", "r_leg_kny"), True), (("l_arm_ely", "neck_ry"), False)],
    ids=["legs", "arms"],
)
def test_walking_with_a_user_leg_is_allowed_and_warned_about_once(joints, named):
    sim = AtlasSimulation()
    command = AtlasSimInterfaceCommand(behavior="WALK")
    for i, y in enumerate((0.14, -0.14)):
        step = AtlasBehaviorStepData(i + 1, i, duration=0.8, swing_height=0.1)
        step.pose.position.y = y
        command.walk_params.step_queue[i] = step
    command.k_effort = 255 * joints_of(sim, *joints)
    sim.publish(command)
    sim.advance(0.2)
    assert len(warnings(sim)) == named
    assert all(name in text for text in warnings(sim) for name in joints)
    assert sim.current_behavior.name == "WALK"


def test_a_user_of_all_joints_is_warned_when_some_are_given_back(take):
    sim = AtlasSimulation()
    take(sim, joints_of(sim, ""))
    sim.advance(0.1)
    assert not warnings(sim)
    take(sim, joints_of(sim, "_leg_"))
    sim.advance(0.1)
    assert len(warnings(sim)) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("behavior", "joints", "k"),
    [
        ("STAND", ["leg_hpy"], 245),
        ("MANIPULATE", ["l_leg_ak", "r_leg_hp"], 255),
    ],
)
def test_without_a_leg_of_its_own_the_robot_holds_its_pose(take, behavior, joints, k):
    sim = robot_in(behavior)
    users = joints_of(sim, *joints)
    pose = np.array(sim.atlas_state.position)
    take(sim, users, k)
    sim.advance(2.0)
    assert not sim.has_fallen
    moved = np.abs(np.array(sim.atlas_state.position) - pose)
    assert moved[~users].max() < 0.05
    assert sim.current_behavior.name == behavior
    # Given back, the legs balance again.
    take(sim, users, k=0)
    sim.advance(0.1)
    sim.apply_push(sim.robot.file.chest, [0.0, 200.0, 0.0], 0.1)
    sim.advance(2.0)
    assert not sim.has_fallen
    assert speed(sim) < 0.1
    assert len(warnings(sim)) == 1


@pytest.mark.slow
@pytest.mark.parametrize("joints", [["l_leg_"], ["leg_hpx", "leg_akx"]])
def test_one_leg_is_enough_to_balance(take, joints):
    sim = robot_in("STAND")
    take(sim, joints_of(sim, *joints))
    sim.advance(0.5)
    sim.apply_push(sim.robot.file.chest, [100.0, 0.0, 0.0], 0.1)
    sim.advance(2.0)
    assert not sim.has_fallen
    assert not warnings(sim)
    assert sim.pelvis_pose.translation()[2] > 0.85


@pytest.mark.slow
@pytest.mark.parametrize(
    ("behavior", "limbs", "k", "seed"),
    [
        ("STAND", ("l_arm", "r_arm", "neck"), 20, 1),
        ("MANIPULATE", ("l_arm", "r_arm", "neck"), 248, 4),
        ("STAND", ("back",), 240, 5),
        ("STAND", ("l_leg", "r_leg"), 25, 6),
    ],
)
def test_shared_joints_leave_the_robot_standing(behavior, limbs, k, seed):
    """The user wants a share of some limbs elsewhere, at once."""
    sim = robot_in(behavior)
    robot, random = sim.robot, np.random.default_rng(seed)
    shared = robot.limb(*limbs)
    target = sim.atlas_state.position + random.uniform(-0.5, 0.5, robot.num_joints)
    command = AtlasCommand(
        position=np.clip(target, robot.position_lower, robot.position_upper),
        kp_position=[200.0] * robot.num_joints,
        kp_velocity=[20.0] * robot.num_joints,
        k_effort=np.where(shared, k, 0),
    )
    sim.publish(command)
    fastest = []
    for _ in range(10):
        sim.advance(0.1)
        fastest.append(speed(sim, ~shared))
    sim.advance(1.5)
    assert not sim.has_fallen
    assert sim.pelvis_pose.translation()[2] > 0.8
    if "neck" in limbs:
        assert max(fastest) < 4.0
        # Arms that two laws hold swing on, slowly.
        assert speed(sim) < 0.3


@pytest.mark.slow
@pytest.mark.parametrize(("behavior", "jump"), [("STAND", 0.05), ("MANIPULATE", -0.05)])
def test_a_back_that_swings_comes_to_rest_and_leaves_the_feet_in_place(
    take, behavior, jump
):
    # The default gains: 4000 N·m/rad and 2 N·m·s/rad at the stiffest.
    def soles(sim):
        poses = sim.atlas_sim_interface_state.foot_pos_est
        return np.array([pose.position.to_array()[:2] for pose in poses])

    sim = robot_in(behavior)
    back = sim.robot.limb("back")
    take(sim, back, jump=jump)
    before = soles(sim)
    sim.advance(2.0)
    assert np.linalg.norm(soles(sim) - before, axis=1).max() < 0.01
    assert speed(sim, back) < 0.3
    assert not sim.has_fallen


@pytest.mark.slow
def test_a_joint_driven_into_its_stop_disturbs_no_other():
    sim = robot_in("STAND")
    robot = sim.robot
    is_neck = robot.limb("neck")
    position = np.where(is_neck, robot.position_upper, sim.atlas_state.position)
    shares, gains = np.where(is_neck, 250, 0), [2000.0] * robot.num_joints
    sim.publish(AtlasCommand(position=position, kp_position=gains, k_effort=shares))
    for _ in range(15):
        sim.advance(0.02)
        assert speed(sim, ~is_neck) < 1.5


@pytest.mark.slow
def test_five_times_the_tutorials_stiffness_comes_to_rest_on_the_ground():
    sim = robot_in("STAND")
    gains = [KP_POSITION.get(joint.name, joint.kp) for joint in sim.robot.file.joints]
    command = AtlasCommand(
        position=sim.robot.stand_prep,
        kp_position=5.0 * np.array(gains),
        kd_position=np.zeros(28),
        kp_velocity=np.full(28, 50.0),
        k_effort=np.full(28, 255),
    )
    sim.publish(command)
    sim.advance(8.0)
    for _ in range(50):
        sim.advance(0.006)
        assert speed(sim) < 0.03


@pytest.mark.slow
def test_no_hand_over_of_the_tutorial_is_a_jump():
    # What comes later, at 15 s, is the user's own doing.
    found = hand_overs(duration=13.6)
    behaviors = [(entry["before"], entry["after"]) for entry in found]
    for change in [("STAND_PREP", "STAND"), ("STAND", "WALK"), ("WALK", "STAND")]:
        assert change in behaviors
    # Taken by the user, given back, some joints and all of them.
    assert {entry["changed"] for entry in found} >= {5, 28}
    for entry in found:
        name, jump = entry.get("the behavior's", ("", 0.0))
        assert jump <= GOAL, (entry["time"], name)
