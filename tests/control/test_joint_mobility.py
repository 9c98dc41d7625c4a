"""The joints' mobility, and the whole robot under the law that relies on it."""

import numpy as np
import pytest

from atlas_drake.control.joint_mobility import JointMobility
from atlas_drake.control.joint_pid import (
    PidInput,
    PidState,
    implicit_gain,
    user_effort,
)

STEPS = 2**15
"""Looked ahead for slow growth."""

PHYSICS_STEPS = (0.0005, 0.001, 0.002)
"""Those that the project offers [s]."""


@pytest.fixture(scope="module")
def mobility(robot):
    return JointMobility(robot)


def test_it_is_the_acceleration_that_efforts_give(model, mobility, random_state):
    context = mobility.create_context()
    for seed in range(5):
        state = random_state(seed)
        state[model.plant.num_positions() :] = 0.0
        terms = model.evaluate(model.create_context(), state)
        found = mobility.evaluate(context, state[: model.plant.num_positions()])
        for joint in range(0, model.robot.num_joints, 5):
            force = np.zeros(6 + model.robot.num_joints)
            force[6 + joint] = 1.0
            expected = np.linalg.solve(terms.M, force)[6:]
            np.testing.assert_allclose(found[:, joint], expected, rtol=1e-6, atol=1e-8)


def test_it_is_symmetric_and_positive(model, mobility, random_state):
    q = random_state(7)[: model.plant.num_positions()]
    found = mobility.evaluate(mobility.create_context(), q)
    np.testing.assert_allclose(found, found.T, rtol=1e-8, atol=1e-8)
    assert np.linalg.eigvalsh(0.5 * (found + found.T))[0] > 0.0


def test_it_does_not_depend_on_where_the_robot_is(model, mobility, random_state):
    q, other = (random_state(3)[: model.plant.num_positions()] for _ in range(2))
    other[:7] = random_state(4)[:7]
    context = mobility.create_context()
    first = mobility.evaluate(context, q)
    np.testing.assert_allclose(mobility.evaluate(context, other), first, rtol=1e-6)
    # A used context is as good as a new one, to the bit.
    fresh = mobility.evaluate(mobility.create_context(), q)
    assert mobility.evaluate(context, q).tobytes() == fresh.tobytes()


def step_matrix(kp, kd, assumed, true, dt):
    """One step of all joints under the law, linear in [q; v; v_last; τ_last].

    Column by column from the law itself. ``assumed`` is the mobility that it relies
    on, ``true`` the one that the joints have; both frozen at a pose.
    """
    n = len(kp)
    q, v, last_v, last_effort = np.split(np.eye(4 * n), 4)
    zero = np.zeros((n, 1))
    command = PidInput(
        position=zero,
        velocity=zero,
        effort=zero,
        kp_position=kp[:, None],
        ki_position=zero,
        kd_position=kd[:, None],
        kp_velocity=zero,
        i_effort_min=zero,
        i_effort_max=zero,
    )
    effort = user_effort(
        PidState(zero, last_v, last_effort),
        command,
        zero,
        q,
        v,
        implicit_gain(kd, np.ones(n), assumed, dt),
        np.full((n, 1), np.inf),
    )
    next_v = v + dt * true @ effort
    return np.vstack([q + dt * next_v, next_v, v, effort])


def grows(step):
    """Whether a motion grows by more than rounding and drift explain.

    A motion that the ground prevents, but the linear step allows, drifts in
    proportion to time; one that grows by e.g. 0.01% a step doubles again and again.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        half = np.linalg.matrix_power(step, STEPS // 2)
        return not np.abs(half @ half).max() <= 3.0 * np.abs(half).max()


@pytest.mark.parametrize("feet", [(), (0,), (0, 1)], ids=["air", "left", "both"])
@pytest.mark.parametrize("dt", PHYSICS_STEPS)
@pytest.mark.parametrize("extra_damping", [0.0, 50.0])
def test_the_whole_robot_is_stable_under_the_law(
    model, robot, mobility, feet, dt, extra_damping
):
    random = np.random.default_rng(8)
    anywhere = random.uniform(robot.position_lower, robot.position_upper)
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(model.plant).q] = robot.stand_prep if feet else anywhere
    terms = model.evaluate(model.create_context(), state)
    true = np.linalg.inv(terms.M)
    if feet:
        # Soles on the ground make joints heavier than the law knows.
        J = np.vstack([terms.feet[foot].J_WF for foot in feet])
        true = true - true @ J.T @ np.linalg.inv(J @ true @ J.T) @ J @ true
    step = step_matrix(
        robot.default_kp,
        robot.default_kd + extra_damping,
        mobility.evaluate(
            mobility.create_context(), state[: model.plant.num_positions()]
        ),
        true[6:, 6:],
        dt,
    )
    assert not grows(step)


def test_a_robot_far_lighter_than_assumed_is_not(robot, mobility, model):
    # That the test above can fail: the law relies on the mobility it is given.
    q = np.zeros(model.plant.num_positions())
    q[0] = 1.0
    assumed = mobility.evaluate(mobility.create_context(), q)
    kd = np.full(robot.num_joints, 50.0)
    assert grows(step_matrix(robot.default_kp, kd, assumed, 2.0 * assumed, 0.001))
