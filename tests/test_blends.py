"""Any mixture of joints under user and behavior control: no violent motion."""

import numpy as np
import pytest

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Scenario,
)

STEP = 0.5
"""How far from where they are the user wants the joints at once [rad]."""


def robot_in(behavior, **scenario):
    """A robot that has been in a behavior for a moment."""
    sim = AtlasSimulation(Scenario(**scenario))
    if behavior != "STAND":
        sim.publish(AtlasSimInterfaceCommand(behavior=behavior))
    sim.advance(0.3)
    return sim


def blended(limbs, k, seed, behavior="STAND"):
    """A robot of which the user wants a share of some limbs elsewhere, at once."""
    sim = robot_in(behavior)
    robot, random = sim.robot, np.random.default_rng(seed)
    command = AtlasCommand()
    target = sim.atlas_state.position + random.uniform(-STEP, STEP, robot.num_joints)
    command.position = np.clip(target, robot.position_lower, robot.position_upper)
    command.kp_position = [200.0] * robot.num_joints
    command.kp_velocity = [20.0] * robot.num_joints
    command.k_effort = np.where(robot.limb(*limbs), k, 0)
    sim.publish(command)
    return sim


def soles(sim):
    """Where the soles are, horizontal [m], shape (2, 2)."""
    poses = sim.atlas_sim_interface_state.foot_pos_est
    return np.array([pose.position.to_array()[:2] for pose in poses])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("behavior", "k", "seed"), [("STAND", 20, 1), ("MANIPULATE", 248, 4)]
)
def test_shared_arms_and_neck_do_not_move_the_rest(behavior, k, seed):
    sim = blended(("l_arm", "r_arm", "neck"), k, seed, behavior)
    others = ~sim.robot.limb("l_arm", "r_arm", "neck")
    for _ in range(10):
        sim.advance(0.1)
        assert np.abs(np.array(sim.atlas_state.velocity)[others]).max() < 4.0
    sim.advance(1.5)
    assert not sim.has_fallen
    assert np.abs(sim.atlas_state.velocity).max() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("limbs", "k", "seed"),
    [(("back",), 60, 5), (("back",), 240, 5), (("l_leg", "r_leg"), 25, 6)],
    ids=["quarter of the back", "most of the back", "tenth of the legs"],
)
def test_a_shared_back_or_leg_leaves_the_robot_standing(limbs, k, seed):
    sim = blended(limbs, k, seed)
    sim.advance(2.5)
    assert not sim.has_fallen
    assert sim.pelvis_pose.translation()[2] > 0.8


@pytest.mark.slow
@pytest.mark.parametrize(("behavior", "jump"), [("STAND", 0.05), ("MANIPULATE", -0.05)])
def test_a_back_that_swings_comes_to_rest_and_leaves_the_feet_in_place(
    take, behavior, jump
):
    # The default gains: 4000 N·m/rad and 2 N·m·s/rad at the stiffest.
    sim = robot_in(behavior)
    back = sim.robot.limb("back")
    take(sim, back, jump=jump)
    before = soles(sim)
    sim.advance(2.0)
    assert np.linalg.norm(soles(sim) - before, axis=1).max() < 0.01
    assert np.abs(np.array(sim.atlas_state.velocity)[back]).max() < 0.3
    assert not sim.has_fallen


@pytest.mark.slow
def test_a_joint_driven_into_its_stop_disturbs_no_other():
    sim = AtlasSimulation()
    sim.advance(0.5)
    robot = sim.robot
    neck = list(robot.joint_names).index("neck_ry")
    command = AtlasCommand()
    command.position = np.array(sim.atlas_state.position)
    command.position[neck] = robot.position_upper[neck]
    command.kp_position = [2000.0] * robot.num_joints
    command.k_effort = np.zeros(robot.num_joints, dtype=int)
    command.k_effort[neck] = 250
    sim.publish(command)
    others = np.arange(robot.num_joints) != neck
    for _ in range(15):
        sim.advance(0.02)
        assert np.abs(np.array(sim.atlas_state.velocity)[others]).max() < 1.5
