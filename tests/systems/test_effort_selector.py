"""The k_effort selector: blended joint by joint, within the motors' limits."""

import numpy as np
import pytest

from atlas_drake.control.joints.blend import blend
from atlas_drake.systems.effort_selector import EffortSelector


@pytest.mark.parametrize(("k", "owner"), [(0, "behavior"), (255, "user")])
def test_at_the_ends_one_side_has_the_joint_alone(k, owner):
    efforts = {"user": np.array([1.25, -30.0]), "behavior": np.array([7.5, 0.1])}
    blended = blend(**efforts, share=np.full(2, k / 255.0), limit=np.full(2, 100.0))
    np.testing.assert_array_equal(blended, efforts[owner])


def test_the_system_blends_per_joint_and_in_the_plants_order(robot):
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
    for joint, name in enumerate(robot.joint_names):
        actuator = next(
            plant.get_joint_actuator(index)
            for index in plant.GetJointActuatorIndices()
            if plant.get_joint_actuator(index).joint().name() == name
        )
        assert actuation[actuator.input_start()] == effort[joint]
