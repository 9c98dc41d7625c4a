"""The k_effort selector: blended joint by joint, within the motors' limits."""

import numpy as np

from atlas_drake.systems.effort_selector import EffortSelector


def test_efforts_are_blended_per_joint_and_in_the_plants_order(robot):
    plant = robot.plant
    selector = EffortSelector(robot, robot.indices(plant))
    context = selector.CreateDefaultContext()
    random = np.random.default_rng(3)
    limit = robot.effort_limit
    user, behavior = random.uniform(-1.5, 1.5, size=(2, 28)) * limit
    k = np.array(([0, 255, 51, 204] * 7), dtype=float)
    for name, value in (
        ("user_effort", user),
        ("behavior_effort", behavior),
        ("k_effort", k),
    ):
        selector.GetInputPort(name).FixValue(context, value)
    effort = selector.GetOutputPort("effort").Eval(context)
    expected = np.clip(k / 255 * user + (1 - k / 255) * behavior, -limit, limit)
    np.testing.assert_allclose(effort, expected)
    assert (np.abs(expected) == limit).any()
    actuation = selector.GetOutputPort("actuation").Eval(context)
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        joint = robot.joint_index(actuator.joint().name())
        assert actuation[actuator.input_start()] == effort[joint]
