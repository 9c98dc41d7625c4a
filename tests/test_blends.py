"""Any mixture of joints under user and behavior control: no violent motion."""

import numpy as np
import pytest

from atlas_drake import AtlasCommand, AtlasSimInterfaceCommand, AtlasSimulation

STEP = 0.5
"""How far from where they are the user wants the joints at once [rad]."""


def robot_in(behavior):
    """A robot that has been in a behavior for a moment."""
    sim = AtlasSimulation()
    sim.publish(AtlasSimInterfaceCommand(behavior=behavior))
    sim.advance(0.3)
    return sim


def blended(limbs, k, seed, behavior="STAND"):
    """A robot of which the user wants a share of some limbs elsewhere, at once."""
    sim = robot_in(behavior)
    robot, random = sim.robot, np.random.default_rng(seed)
    target = sim.atlas_state.position + random.uniform(-STEP, STEP, robot.num_joints)
    command = AtlasCommand(
        position=np.clip(target, robot.position_lower, robot.position_upper),
        kp_position=[200.0] * robot.num_joints,
        kp_velocity=[20.0] * robot.num_joints,
        k_effort=np.where(robot.limb(*limbs), k, 0),
    )
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
    is_neck = robot.limb("neck")
    position = np.where(is_neck, robot.position_upper, sim.atlas_state.position)
    shares, gains = np.where(is_neck, 250, 0), [2000.0] * robot.num_joints
    sim.publish(AtlasCommand(position=position, kp_position=gains, k_effort=shares))
    for _ in range(15):
        sim.advance(0.02)
        assert np.abs(np.array(sim.atlas_state.velocity)[~is_neck]).max() < 1.5
