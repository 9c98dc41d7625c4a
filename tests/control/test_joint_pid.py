"""The joint law: the published formula, its limits, and stability at any gains."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.joints.joint_pid import (
    JointCommand,
    integrate,
    motor_law,
    user_effort,
    within_limits,
)

STEP = 0.003
"""Physics step [s]."""


@pytest.fixture
def random():
    return np.random.default_rng(5)


@pytest.fixture
def command(random):
    """Every term of the law at work on ten joints, with shares of 0 to 1."""
    fields = [field.name for field in dataclasses.fields(JointCommand)]
    values = {name: random.uniform(0.5, 2.0, 10) for name in fields}
    return JointCommand(**values | {"k_effort": np.linspace(0.0, 255.0, 10)})


def written_law(c, integral, q, v):
    """The reference's formula, with ė = -v as set-points are constant."""
    return (
        c.kp_position * (c.position - q)
        + integral
        + c.kd_position * -v
        + c.kp_velocity * (c.velocity - v)
        + c.effort
    )


def test_the_effort_is_the_written_law_at_the_velocity_after_the_step(random, command):
    integral, q, v = random.normal(size=(3, 10))
    np.testing.assert_allclose(
        user_effort(command, integral, q, v, STEP),
        written_law(command, integral, q, v),
    )


@pytest.mark.parametrize("kp", [1.0, 1e5])
def test_a_motor_gives_the_users_share_of_it(random, command, kp):
    command = dataclasses.replace(command, kp_position=np.full(10, kp))
    integral, q, v = random.normal(size=(3, 10))
    law = motor_law(command, integral, STEP)
    q_next = q + STEP * v
    given = law.stiffness * (law.position - q_next) - law.damping * v + law.feed_forward
    share = command.k_effort / 255.0
    expected = share * user_effort(command, integral, q, v, STEP)
    np.testing.assert_allclose(given, expected, rtol=1e-9, atol=1e-9)
    assert (law.damping >= 0.0).all()


@pytest.mark.parametrize("kp", [10.0, 1e3, 1e9])
@pytest.mark.parametrize("kd", [0.0, 1.0, 1e6])
@pytest.mark.parametrize("heavier", [1.0, 1e4])
def test_two_joints_come_to_rest_whatever_they_weigh(kp, kd, heavier):
    # Coupled as hip and knee are, with Drake's step: v⁺ and q⁺ at the same time.
    mass = heavier * np.array([[0.02, 0.012], [0.012, 0.01]])
    nothing = np.zeros(2)
    values = dict.fromkeys((f.name for f in dataclasses.fields(JointCommand)), nothing)
    command = JointCommand(
        **values
        | {
            "kp_position": np.full(2, kp),
            "kd_position": np.full(2, kd),
            "k_effort": np.full(2, 255.0),
        }
    )
    law = motor_law(command, nothing, STEP)
    q, v = np.array([0.1, -0.2]), nothing
    p, d = np.diag(law.stiffness), np.diag(law.damping)

    def energy():
        return v @ mass @ v + q @ p @ q

    begin = energy()
    for _ in range(200):
        v = np.linalg.solve(mass + STEP * (d + STEP * p), mass @ v - STEP * p @ q)
        q = q + STEP * v
        assert energy() <= 1.3 * begin


def test_a_spring_gains_and_loses_no_energy_beside_a_damper_that_is_strong_enough():
    # 10 s of a swing with the damping that the law is given anyway, h·kp: next to none
    # of it may come on top of the user's.
    command = JointCommand(
        **dict.fromkeys((f.name for f in dataclasses.fields(JointCommand)), np.zeros(1))
        | {"kp_position": np.array([400.0]), "kd_position": np.array([1.5])}
        | {"k_effort": np.array([255.0])}
    )
    law = motor_law(command, np.zeros(1), STEP)
    inertia, q, v, peaks = 2.0, np.array([0.3]), np.zeros(1), []
    for _ in range(round(10.0 / STEP)):
        mass = inertia + STEP * (law.damping + STEP * law.stiffness)
        before, v = v, (inertia * v - STEP * law.stiffness * q) / mass
        q = q + STEP * v
        if before < 0.0 <= v:
            peaks.append(-q[0])
    decay = np.log(peaks[0] / peaks[-1]) / (len(peaks) - 1)
    frequency = np.sqrt(400.0 / inertia)
    expected = np.pi * 1.5 / inertia / frequency
    assert decay == pytest.approx(expected, rel=0.01)


def test_set_points_stay_within_the_limits_and_drive_no_joint_outward(command):
    lower, upper = np.full(10, -1.0), np.full(10, 1.0)
    for out in (1.0, -1.0):
        for beyond in (0.0, 0.3):
            asked = dataclasses.replace(
                command,
                position=np.full(10, out * (1.0 + beyond)),
                velocity=np.full(10, out),
            )
            found = within_limits(asked, lower, upper)
            np.testing.assert_array_equal(found.position, np.full(10, out))
            np.testing.assert_array_equal(found.velocity, np.zeros(10))
    inward = dataclasses.replace(asked, velocity=np.ones(10))
    np.testing.assert_array_equal(
        within_limits(inward, lower, upper).velocity, np.ones(10)
    )


def test_the_integral_grows_within_its_clamps_where_the_user_has_a_share(command):
    command = dataclasses.replace(
        command,
        ki_position=np.full(10, 100.0),
        position=np.full(10, 0.1),
        i_effort_min=np.full(10, -0.5),
        i_effort_max=np.full(10, 1.5),
    )
    integral = np.zeros(10)
    integral = integrate(integral, command, np.zeros(10), 0.1)
    np.testing.assert_allclose(integral, [0.0, *[1.0] * 9])
    for q, clamp in ((0.0, 1.5), (0.5, -0.5)):
        for _ in range(5):
            integral = integrate(integral, command, np.full(10, q), 0.1)
        np.testing.assert_array_equal(integral, [0.0, *[clamp] * 9])
