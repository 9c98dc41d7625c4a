"""The motors keep joints to their planned speeds between two control ticks."""

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Scenario
from atlas_drake.control.joints.speed_hold import FALL_DAMPING, SpeedHold, damped
from atlas_drake.systems.whole_body_controller import YIELDING

V, ACCELERATION = np.array([1.0, -2.0, 0.0]), np.array([10.0, 0.0, -40.0])
DAMPING, PERIOD = np.array([5.0, 1.0, 2.0]), 0.01


def effort(hold, v):
    """What a motor adds at the end of a step."""
    return hold.damping * (hold.speed - v)


def test_a_joint_that_moves_as_planned_gets_nothing_in_the_mean_of_a_tick():
    hold = SpeedHold.planned(V, ACCELERATION, DAMPING, PERIOD)
    times = np.linspace(0.0, PERIOD, 11)
    given = [effort(hold, V + ACCELERATION * t) for t in times]
    np.testing.assert_allclose(np.mean(given, axis=0), 0.0, atol=1e-12)


def test_a_joint_is_braked_by_what_it_is_too_fast():
    hold = SpeedHold.planned(V, 0.0 * V, DAMPING, PERIOD)
    np.testing.assert_allclose(effort(hold, V + 2.0), -2.0 * DAMPING)


def test_the_joints_of_a_falling_robot_are_only_braked():
    limit = np.array([10.0, 20.0, 30.0])
    np.testing.assert_allclose(effort(damped(limit), V), -FALL_DAMPING * limit * V)


def dampings(sim):
    """Damping of every motor of the robot, in its greatest effort per rad/s, (n,)."""
    plant, robot = sim.plant, sim.robot
    found = np.zeros(robot.num_joints)
    for index in plant.GetJointActuatorIndices(robot.instance(plant)):
        motor = plant.get_joint_actuator(index)
        if motor.has_controller():
            joint = robot.joint_index(motor.joint().name())
            found[joint] = motor.get_controller_gains().d / robot.effort_limit[joint]
    return found


@pytest.mark.slow
@pytest.mark.parametrize("hold", [0.0, 0.06])
def test_the_motors_of_back_and_legs_on_the_ground_hold_speeds(hold):
    scenario = Scenario(controller={"gains": {"speed_hold": hold}})
    sim = AtlasSimulation(scenario)
    sim.advance(0.05)
    back, (left, right) = (
        sim.robot.limb("back"),
        map(sim.robot.limb, ("l_leg", "r_leg")),
    )
    np.testing.assert_allclose(dampings(sim), hold * (back | left | right))
    walk = AtlasSimInterfaceCommand(behavior="WALK")
    walk.walk_params.use_demo_walk = True
    sim.publish(walk)
    while sim.record.feet.loads[0] > 0.0:
        assert sim.time < 3.0
        sim.advance(sim.scenario.control_period)
    sim.advance(0.1)
    expected = hold * (1.0 * (back | right) + YIELDING * left)
    np.testing.assert_allclose(dampings(sim), expected)
