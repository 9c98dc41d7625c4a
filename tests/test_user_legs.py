"""Legs under user control: the behaviors with their remaining joints."""

import numpy as np
import pytest

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
)
from atlas_drake.simulation.tutorial import KP_POSITION


def joints_of(sim, *parts):
    """Joints whose names hold one of these, bool, shape (n,)."""
    names = sim.robot.joint_names
    return np.array([any(part in name for part in parts) for name in names])


def warnings(sim):
    return [event.text for event in sim.events if event.kind == "warning"]


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
    sim = AtlasSimulation()
    sim.publish(AtlasSimInterfaceCommand(behavior=behavior))
    sim.advance(0.3)
    users = joints_of(sim, *joints)
    pose = np.array(sim.atlas_state.position)
    take(sim, users, k)
    sim.advance(2.0)
    assert not sim.has_fallen
    moved = np.abs(np.array(sim.atlas_state.position) - pose)
    assert moved[~users].max() < 0.05
    assert len(warnings(sim)) == 1
    assert sim.current_behavior.name == behavior
    # Given back, the legs balance again.
    take(sim, users, k=0)
    sim.advance(0.1)
    sim.apply_push(sim.robot.file.chest, [0.0, 200.0, 0.0], 0.1)
    sim.advance(2.0)
    assert not sim.has_fallen
    assert np.abs(sim.atlas_state.velocity).max() < 0.1
    assert len(warnings(sim)) == 1


@pytest.mark.slow
@pytest.mark.parametrize("joints", [["l_leg_"], ["leg_hpx", "leg_akx"]])
def test_one_leg_is_enough_to_balance(take, joints):
    sim = AtlasSimulation()
    sim.advance(0.2)
    take(sim, joints_of(sim, *joints))
    sim.advance(0.5)
    sim.apply_push(sim.robot.file.chest, [100.0, 0.0, 0.0], 0.1)
    sim.advance(2.0)
    assert not sim.has_fallen
    assert not warnings(sim)
    assert sim.pelvis_pose.translation()[2] > 0.85


@pytest.mark.slow
def test_five_times_the_tutorials_stiffness_comes_to_rest_on_the_ground():
    sim = AtlasSimulation()
    sim.advance(1.0)
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
        assert np.abs(sim.atlas_state.velocity).max() < 0.03
