"""The inverse mass matrix of the joint law."""

import numpy as np
import pytest

from atlas_drake.control.joints.joint_pid import InverseMass

from .conftest import TUTORIAL_ROBOTS

pytestmark = pytest.mark.parametrize(
    "robot", TUTORIAL_ROBOTS, indirect=True, scope="session"
)


def test_the_inverse_mass_is_the_acceleration_that_efforts_give(
    robot, model, random_state
):
    inverse_mass = InverseMass(robot)
    context = inverse_mass.create_context()
    for seed in range(5):
        state = random_state(seed)
        state[model.plant.num_positions() :] = 0.0
        terms = model.evaluate(model.create_context(), state)
        q = state[: model.plant.num_positions()]
        found = inverse_mass.evaluate(context, q)
        # A used context is as good as a new one, to the bit.
        fresh = inverse_mass.evaluate(inverse_mass.create_context(), q)
        assert found.tobytes() == fresh.tobytes()
        for joint in range(0, model.robot.num_joints, 5):
            force = np.zeros(6 + model.robot.num_joints)
            force[6 + joint] = 1.0
            expected = np.linalg.solve(terms.M, force)[6:]
            np.testing.assert_allclose(found[:, joint], expected, rtol=1e-6, atol=1e-8)
