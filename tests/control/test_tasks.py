"""Feedback laws of single tasks: each closed loop behaves as documented."""

import numpy as np
import pytest

from atlas_drake.control.balance.feedback import (
    dcm,
    height_acceleration,
    pendulum_frequency,
)
from atlas_drake.control.gains import PdGains
from atlas_drake.control.joints.damping import damping_effort, damping_mode_gain
from atlas_drake.control.whole_body.model import GRAVITY

GAINS = PdGains(kp=50.0, kd=8.0)


@pytest.fixture
def terms(model, random_state):
    return model.evaluate(model.create_context(), random_state(2))


def test_pendulum_frequency():
    assert pendulum_frequency(0.9) ** 2 * 0.9 == pytest.approx(GRAVITY)
    # Of a robot that lies on the ground, or below it, that of a very short one.
    assert pendulum_frequency(-0.1) ** 2 * 0.3 == pytest.approx(GRAVITY)


def test_dcm_is_the_com_and_its_velocity(terms):
    expected = terms.com[:2] + terms.com_velocity[:2] / 3.0
    np.testing.assert_allclose(dcm(terms, 3.0), expected)


def test_height_acceleration(terms):
    z, rate = terms.com[2], terms.com_velocity[2]
    assert height_acceleration(terms, z, rate, GAINS) == 0.0
    assert height_acceleration(terms, z + 0.1, rate, GAINS) == pytest.approx(5.0)
    assert height_acceleration(terms, z, rate + 0.1, GAINS) == pytest.approx(0.8)


@pytest.mark.parametrize(("period", "gain"), [(0.002, 0.002), (0.008, 0.001)])
def test_a_falling_robot_damps_its_joints_within_their_limits(period, gain):
    limit = np.array([100.0, 5.0])
    np.testing.assert_allclose(damping_mode_gain(limit, period), gain * limit)
    v = np.array([-10.0, 1e4])
    np.testing.assert_allclose(
        damping_effort(v, limit, period), [gain * 1e3, -limit[1]]
    )
