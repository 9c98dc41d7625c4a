"""The legs' closed form against Drake's kinematics, on every robot."""

import numpy as np
import pytest

from atlas_drake.control.feet.leg_kinematics import solve_leg
from atlas_drake.robot import KNEE, available_robots

# Also one with legs beside the hips' centers.
pytestmark = pytest.mark.parametrize(
    "robot", available_robots(), indirect=True, scope="session"
)


@pytest.fixture(scope="module")
def legs(model):
    return model.robot.legs


def evaluate(model, random_state, legs, seed):
    """Terms at a random state; knees bent forward and feet below the hips, as ever."""
    state = random_state(seed)
    positions = model.robot.indices(model.plant).q
    for leg in legs:
        state[positions[leg.joints]] *= 0.7
        knee = positions[leg.joints[KNEE]]
        state[knee] = max(state[knee], 0.2)
    return model.evaluate(model.create_context(), state)


def sole_in_pelvis(terms, foot):
    sole = terms.feet[foot]
    return terms.R_WP.T @ (sole.p_WF - terms.p_WP), terms.R_WP.T @ sole.R_WF


@pytest.mark.parametrize("foot", [0, 1])
def test_angles_are_those_that_put_the_sole_there(model, random_state, legs, foot):
    for seed in range(20):
        terms = evaluate(model, random_state, legs, seed)
        held = solve_leg(legs[foot], *sole_in_pelvis(terms, foot))
        np.testing.assert_allclose(held.angles, terms.q[legs[foot].joints], atol=1e-9)


@pytest.mark.parametrize("foot", [0, 1])
def test_torques_are_those_of_the_jacobian(model, random_state, legs, foot):
    terms = evaluate(model, random_state, legs, 5)
    p_PF, R_PF = sole_in_pelvis(terms, foot)
    force_W = np.array([30.0, -50.0, 400.0])
    lever_W = np.array([0.05, -0.02, 0.0])
    torques = solve_leg(legs[foot], p_PF, R_PF).torques(
        p_PF + terms.R_WP.T @ lever_W, terms.R_WP.T @ force_W
    )
    wrench = np.concatenate([np.cross(lever_W, force_W), force_W])
    expected = -(terms.feet[foot].J_WF[:, 6:].T @ wrench)[legs[foot].joints]
    np.testing.assert_allclose(torques, expected, atol=1e-9)


def test_feet_out_of_reach_have_no_joint_angles(legs):
    reach = np.array([0.0, 0.09, -1.2])
    assert solve_leg(legs[0], reach, np.eye(3)) is None
    assert solve_leg(legs[0], np.array([0.0, 0.09, 0.5]), np.eye(3)) is None
    assert solve_leg(legs[0], np.array([0.0, 0.09, -0.85]), np.eye(3)) is not None
