"""The joint law: the published formula at steady state, and limits."""

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

PHYSICS_STEPS = (0.0005, 0.003)
"""Shortest and longest that the project offers [s]."""

UNLIMITED = 1e9
"""Effort limit that is never reached [N·m]."""


def command_of(n=1, **fields):
    """A command that is zero but for the fields given."""
    values = {field.name: np.zeros(n) for field in dataclasses.fields(JointCommand)}
    return JointCommand(**values | {k: np.full(n, v, float) for k, v in fields.items()})


def state_of(n=1, integral=0.0):
    """What the law remembers of joints at rest that nothing pushes."""
    nothing = np.zeros(n)
    return PidState(np.full(n, float(integral)), *[nothing] * 4)


def remembered(integral, v, applied, drift, model, static=0.0):
    """What the law remembers of a step in which it gave these efforts."""
    expected = drift + model.response @ applied
    return PidState(integral, v, applied, expected, np.broadcast_to(static, v.shape))


def estimate_drift(state, v, model, static=0.0):
    """What the law takes for the doing of no motor."""
    static = np.broadcast_to(static, v.shape)
    return change_without_user(state, static, v, np.zeros_like(v), model)


def written_law(c, integral, q, v):
    """The reference's formula, with ė = -v as set-points are constant."""
    return (
        c.kp_position * (c.position - q)
        + integral
        + c.kd_position * -v
        + c.kp_velocity * (c.velocity - v)
        + c.effort
    )


def model_of(command, inertia, dt, share=1.0):
    """How joints answer in a step that do not move each other."""
    n = len(command.position)
    return step_model(
        command.kp_position,
        command.kd_position + command.kp_velocity,
        np.full(n, share),
        np.diag(1.0 / np.broadcast_to(inertia, n)),
        dt,
    )


def effort_of(command, integral, q, v, drift, model, others=0.0, limit=UNLIMITED):
    """The law, with one limit for all joints unless ``limit`` is an array."""
    others = np.broadcast_to(others, q.shape)
    return user_effort(
        static_effort(command, integral, q),
        v + drift + model.response @ others,
        others,
        model,
        np.broadcast_to(limit, q.shape),
    )[0]


@pytest.fixture
def random():
    return np.random.default_rng(5)


@pytest.fixture
def random_command(random):
    """Every term of the law at work on ten joints."""
    fields = [field.name for field in dataclasses.fields(JointCommand)]
    return JointCommand(**{name: random.uniform(0.5, 2.0, 10) for name in fields})


@pytest.mark.parametrize("velocity", [0.0, 0.7, -3.0])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_at_steady_velocity_the_effort_settles_at_the_law(
    random, random_command, velocity, share
):
    # Whatever the behavior adds, and whatever balances it.
    others, v, q = random.normal(size=10), np.full(10, velocity), np.zeros(10)
    state = PidState(q, v, q, q, q)
    model = model_of(random_command, 0.01, 0.001, share)
    for _ in range(400):
        drift = estimate_drift(state, v, model)
        effort = effort_of(random_command, q, q, v, drift, model, others)
        state = remembered(q, v, others + share * effort, drift, model)
    np.testing.assert_allclose(effort, written_law(random_command, q, q, v))


@pytest.mark.parametrize("every", [1, 3, 5])
def test_a_streamed_set_point_is_damped_as_the_law_says(every):
    # So stiff that a part of the stiffness acts at once; the set-point moves with the
    # joint, in jumps.
    dt, v, inertia = 0.003, np.array([0.4]), 0.01
    command = command_of(kp_position=900.0, kd_position=50.0)
    model = model_of(command, inertia, dt)
    assert model.prompt[0] > 0.3
    q, state, efforts = np.zeros(1), state_of(), []
    for step in range(600):
        streamed = dataclasses.replace(command, position=q - step % every * dt * v)
        static = static_effort(streamed, np.zeros(1), q)
        drift = estimate_drift(state, v, model, static)
        effort = effort_of(streamed, np.zeros(1), q, v, drift, model)
        state = remembered(np.zeros(1), v, effort, drift, model, static)
        efforts.append(effort[0] - static[0])
        q = q + dt * v
    assert np.mean(efforts[300:]) == pytest.approx(-50.0 * v[0], rel=0.01)


def coupled(random, dt=0.002):
    """Ten joints that move each other, shares of 0 to 1, and light to heavy damping.

    Returns:
        Shares, damping and the model.
    """
    root = random.normal(size=(10, 10))
    share = np.array([0.0, 0.0, 0.01, 0.2, 0.7, 1.0, 1.0, 1.0, 1.0, 1.0])
    damping = np.array([0.0, 9.0, 5.0, 50.0, 500.0, 0.0, 1e-6, 2.0, 50.0, 500.0])
    inverse_mass = 10.0 * (root @ root.T + np.eye(10))
    return share, damping, step_model(np.zeros(10), damping, share, inverse_mass, dt)


@pytest.mark.parametrize("scale", [0.01, 3.0, 100.0, 1e6])
def test_motors_at_their_limit_leave_the_others_to_their_law(random, scale):
    share, damping, model = coupled(random)
    limit = random.uniform(5.0, 50.0, 10)
    static = scale * limit * random.normal(size=10)
    others = (1.0 - share) * limit * random.uniform(-1.0, 1.0, 10)
    idle = random.normal(size=10)
    effort, total = user_effort(
        static, idle + model.response @ others, others, model, limit
    )
    next_v = idle + model.response @ total
    law = static - damping * next_v
    np.testing.assert_allclose(
        effort[share > 0.0], law[share > 0.0], rtol=1e-7, atol=1e-4
    )
    blend = np.clip(share * law + others, -limit, limit)
    np.testing.assert_allclose(total, blend, rtol=1e-7, atol=1e-4)
    # And the selector comes to the same.
    np.testing.assert_allclose(
        np.clip(share * effort + others, -limit, limit), total, atol=1e-9
    )
    assert (np.abs(total) == limit).any() or scale < 1.0


def test_the_behaviors_own_joints_are_not_the_laws_to_limit():
    model = step_model(np.zeros(2), np.zeros(2), np.array([0.0, 1.0]), np.eye(2), 0.001)
    others = np.array([10.0 + 1e-9, 0.0])
    effort, total = user_effort(
        np.array([5.0, 3.0]), np.zeros(2), others, model, np.array([10.0, 10.0])
    )
    assert total.tolist() == [10.0 + 1e-9, 3.0]
    assert effort[1] == 3.0


def test_the_law_holds_for_the_velocity_at_the_steps_end(random, random_command):
    # Joints that move each other, the behavior's share, and what no motor does.
    root = random.normal(size=(10, 10))
    inverse_mass = root @ root.T + np.eye(10)
    share, dt = random.uniform(0.1, 1.0, 10), 0.01
    damping = random_command.kd_position + random_command.kp_velocity
    model = step_model(random_command.kp_position, damping, share, inverse_mass, dt)
    q, v, drift, others, integral = random.normal(size=(5, 10))
    effort = effort_of(random_command, integral, q, v, drift, model, others)
    next_v = v + drift + dt * inverse_mass @ (others + share * effort)
    np.testing.assert_allclose(effort, written_law(random_command, integral, q, next_v))


def test_drift_is_what_the_motors_do_not_explain(random):
    response = 0.1 * random.normal(size=(10, 10))
    model = dataclasses.replace(
        step_model(np.zeros(10), np.zeros(10), np.ones(10), np.eye(10), 0.001),
        response=response,
    )
    true, v = random.normal(size=(2, 10))
    state = PidState(np.zeros(10), v, random.normal(size=10), *[np.zeros(10)] * 2)
    for _ in range(60):
        next_v = state.velocity + true + response @ state.applied
        drift = estimate_drift(state, next_v, model)
        applied = random.normal(size=10)
        state = remembered(state.integral, next_v, applied, drift, model)
    np.testing.assert_allclose(drift, true, rtol=1e-6)


@pytest.mark.parametrize("dt", PHYSICS_STEPS)
def test_a_jolt_enters_the_drift_by_its_share_of_time_alone(dt):
    model = step_model(np.zeros(1), np.zeros(1), np.ones(1), np.eye(1), dt)
    jolt = np.array([1.0])
    drift = estimate_drift(state_of(), jolt, model)
    assert 0.0 < drift[0] <= 0.75
    # It fades, and never turns round.
    state = remembered(np.zeros(1), jolt, np.zeros(1), drift, model)
    after = estimate_drift(state, jolt, model)
    assert 0.0 <= after[0] < drift[0]


def test_the_behaviors_efforts_are_known_at_once(random):
    # A motor that the behavior has moves its neighbors in this very step.
    inverse_mass = np.eye(10) + 0.1
    model = step_model(np.zeros(10), np.zeros(10), np.ones(10), inverse_mass, 0.001)
    v, before, others = random.normal(size=(3, 10))
    expected = model.response @ before
    zero = np.zeros(10)
    state = PidState(zero, v - expected, before, expected, zero)
    np.testing.assert_allclose(
        change_without_user(state, zero, v, others, model), model.response @ others
    )


def test_a_change_of_the_model_is_no_jolt(random_command):
    # A joint at rest under load stays so when the model becomes another one.
    v = np.zeros(10)
    command = dataclasses.replace(random_command, velocity=v)
    heavy, light = (model_of(command, inertia, 0.001) for inertia in (10.0, 0.01))
    static = written_law(command, v, v, v)
    held = PidState(v, v, static, v, v)
    for model in (heavy, light, heavy):
        drift = estimate_drift(held, v, model)
        effort = effort_of(command, v, v, v, drift, model)
        np.testing.assert_allclose(effort, static)
        held = remembered(v, v, effort, drift, model)


@pytest.mark.parametrize("robot", TUTORIAL_ROBOTS, indirect=True, scope="session")
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
