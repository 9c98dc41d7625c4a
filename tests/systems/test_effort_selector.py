"""The k_effort selector: efforts blended joint by joint, and the motors' gains."""

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.control.joints.joint_pid import MotorLaw
from atlas_drake.control.joints.speed_hold import SpeedHold
from atlas_drake.systems.effort_selector import EffortSelector

K = np.array([0, 255, 51, 204] * 7) / 255
"""The user's blend weight of each joint."""


@pytest.fixture
def plant(robot):
    """One whose motors a test may change."""
    plant = MultibodyPlant(time_step=0.001)
    robot.add_to(plant)
    plant.Finalize()
    return plant


def fed(selector, **values):
    """A context of the selector with these inputs."""
    context = selector.CreateDefaultContext()
    for name, value in values.items():
        selector.GetInputPort(name).FixValue(context, value)
    return context


def law_of(stiffness, feed_forward):
    on = (K > 0).astype(float)
    return MotorLaw(stiffness * on, 2.0 * on, np.linspace(0.0, 1.0, 28), feed_forward)


def motors(robot, plant):
    """The joints of the plant's motors, by the place of their actuation."""
    found = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
    return {motor: robot.joint_index(motor.joint().name()) for motor in found}


def test_efforts_are_blended_per_joint_and_in_the_plants_order(robot, plant):
    selector = EffortSelector(robot, plant)
    random = np.random.default_rng(3)
    limit = robot.effort_limit
    behavior, added = random.uniform(-1.5, 1.5, size=(2, 28)) * limit
    context = fed(
        selector,
        received_effort=behavior,
        k=K,
        motor_law=law_of(5.0, added * (K > 0)),
        state=plant.GetPositionsAndVelocities(plant.CreateDefaultContext()),
    )
    rest = (1 - K) * behavior
    # A motor that has gains limits the sum itself.
    expected = np.where(K > 0, added + rest, np.clip(behavior, -limit, limit))
    actuation = selector.GetOutputPort("actuation").Eval(context)
    for motor, joint in motors(robot, plant).items():
        assert actuation[motor.input_start()] == pytest.approx(expected[joint])


def test_held_speeds_have_the_behaviors_share_of_efforts_and_gains(robot, plant):
    selector, ones = EffortSelector(robot, plant), np.ones(28)
    context = fed(
        selector,
        received_effort=ones,
        k=K,
        motor_law=law_of(5.0, 3.0 * (K > 0)),
        received_hold=SpeedHold(4.0 * ones, 0.5 * ones),
        state=plant.GetPositionsAndVelocities(plant.CreateDefaultContext()),
    )
    actuation = selector.GetOutputPort("actuation").Eval(context)
    for motor, joint in motors(robot, plant).items():
        user, rest = 1.0 * (K[joint] > 0), 1.0 - K[joint]
        expected = 3.0 * user + 3.0 * rest
        assert actuation[motor.input_start()] == pytest.approx(expected)
        gains = motor.get_controller_gains()
        assert gains.p == pytest.approx(5.0 * user)
        assert gains.d == pytest.approx(2.0 * user + 4.0 * rest)


def test_every_context_gives_the_motors_its_own_gains(robot, plant):
    selector, nothing = EffortSelector(robot, plant), np.zeros(28)
    state = plant.GetPositionsAndVelocities(plant.CreateDefaultContext())
    common = {"received_effort": nothing, "k": K, "state": state}
    laws = [law_of(stiffness, nothing) for stiffness in (5.0, 7.0)]
    contexts = [fed(selector, motor_law=law, **common) for law in laws]
    wanted = selector.GetOutputPort("desired_state")
    for turn in range(3):
        for law, context in zip(laws, contexts, strict=True):
            selector.GetInputPort("state").FixValue(context, state + turn)
            selector.GetOutputPort("actuation").Eval(context)
            assert wanted.Eval(context).shape == (56,)
            for motor, joint in motors(robot, plant).items():
                assert motor.has_controller() == (K[joint] > 0)
                if motor.has_controller():
                    gains = motor.get_controller_gains()
                    assert gains.p == law.stiffness[joint]
                    assert gains.d == law.damping[joint]
