"""The inverse mass matrix, and the robot under the law that uses it."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.joints.joint_pid import (
    InverseMass,
    JointCommand,
    PidState,
    change_without_user,
    static_effort,
    step_model,
    user_effort,
)

from .conftest import TUTORIAL_ROBOTS

pytestmark = pytest.mark.parametrize(
    "robot", TUTORIAL_ROBOTS, indirect=True, scope="session"
)

NEGLIGIBLE = 0.05
"""Growth that the friction of joints and ground, not modeled here, exceeds [1/s]."""

PHYSICS_STEPS = (0.0005, 0.003)
"""Shortest and longest that the project offers [s]."""

FOOTHOLDS = {"air": (False, False), "left": (True, False), "both": (True, True)}
"""Which soles the ground holds."""


@pytest.fixture(scope="module")
def inverse_mass(robot):
    return InverseMass(robot)


def test_the_inverse_mass_is_the_acceleration_that_efforts_give(
    model, inverse_mass, random_state
):
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


def constrained(terms, planted):
    """How the whole robot gives way when soles do not move, shape (6 + n, 6 + n)."""
    free = np.linalg.inv(terms.M)
    feet = [terms.feet[foot].J_WF for foot in (0, 1) if planted[foot]]
    if not feet:
        return free
    J = np.vstack(feet)
    return free - free @ J.T @ np.linalg.pinv(J @ free @ J.T) @ J @ free


def bent_knees(model):
    """The stand-prep pose: knees bent, so that twelve constraints are independent."""
    robot = model.robot
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(model.plant).q] = robot.stand_prep
    return state


def step_matrix(kp, kd, assumed, true, dt):
    """One step of all joints under the law, linear in what they are and remember.

    That is [q; v; last v; last effort; expected]. Column by column from the law itself.
    ``assumed`` is the inverse_mass that it relies on, ``true`` the one that the joints
    have; both frozen at a pose.
    """
    n = len(kp)
    q, v, last_v, applied, expected = np.split(np.eye(5 * n), 5)
    zero = np.zeros((n, 1))
    command = JointCommand(
        position=zero,
        velocity=zero,
        effort=zero,
        kp_position=kp[:, None],
        ki_position=zero,
        kd_position=kd[:, None],
        kp_velocity=zero,
        i_effort_min=zero,
        i_effort_max=zero,
        k_effort=zero,
    )
    law = step_model(kp, kd, np.ones(n), assumed, dt)
    law = dataclasses.replace(
        law,
        damping=kd[:, None],
        share=np.ones((n, 1)),
        prompt=law.prompt[:, None],
        stiffness=law.stiffness[:, None],
    )
    static = static_effort(command, zero, q)
    # The set-points rest: the static effort changed by what the joints moved.
    last = PidState(zero, last_v, applied, expected, static + law.stiffness * v)
    others = np.zeros_like(q)
    drift = change_without_user(last, static, v, others, law)
    unlimited = np.full((n, 1), np.inf)
    effort, _ = user_effort(static, v + drift, others, law, unlimited)
    next_v = v + dt * true @ effort
    expected = drift + law.response @ effort
    return np.vstack([q + dt * next_v, next_v, v, effort, expected])


def growth(step, dt):
    """Rate at which the fastest motion grows [1/s]."""
    return np.log(np.abs(np.linalg.eigvals(step)).max()) / dt


@pytest.mark.slow
@pytest.mark.parametrize("planted", FOOTHOLDS.values(), ids=FOOTHOLDS)
@pytest.mark.parametrize(
    ("dt", "extra_damping"), [(PHYSICS_STEPS[0], 50.0), (PHYSICS_STEPS[1], 0.0)]
)
def test_the_whole_robot_is_stable_under_the_law(
    model, robot, inverse_mass, planted, dt, extra_damping
):
    # The law does not know which soles are on the ground.
    state = bent_knees(model)
    if not any(planted):
        random = np.random.default_rng(8)
        anywhere = random.uniform(robot.position_lower, robot.position_upper)
        state[robot.indices(model.plant).q] = anywhere
    terms = model.evaluate(model.create_context(), state)
    step = step_matrix(
        robot.default_kp,
        robot.default_kd + extra_damping,
        inverse_mass.evaluate(
            inverse_mass.create_context(), state[: model.plant.num_positions()]
        ),
        constrained(terms, planted)[6:, 6:],
        dt,
    )
    assert growth(step, dt) < NEGLIGIBLE
