"""Feedback laws of single tasks: each closed loop behaves as documented."""

import math

import numpy as np
import pytest

from atlas_drake.control.balance.feedback import (
    dcm,
    height_acceleration,
    pendulum_frequency,
    stance_acceleration,
)
from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.control.whole_body.tasks import orientation_acceleration
from atlas_drake.rotations import rotation_z

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


def test_orientation_acceleration_turns_towards_the_target():
    w = np.array([0.1, -0.2, 0.3])
    now, desired = rotation_z(0.5), rotation_z(0.6)
    still = orientation_acceleration(now, w, now, w, GAINS)
    np.testing.assert_allclose(still, 0.0, atol=1e-15)
    towards = orientation_acceleration(desired, w, now, w, GAINS)
    np.testing.assert_allclose(towards, [0.0, 0.0, 50.0 * math.sin(0.1)], atol=1e-12)
    braked = orientation_acceleration(now, 0.0 * w, now, w, GAINS)
    np.testing.assert_allclose(braked, -8.0 * w, atol=1e-12)


def test_stance_acceleration_opposes_the_soles_velocity(terms):
    foot = terms.feet[1]
    np.testing.assert_allclose(stance_acceleration(foot, 12.0), -12.0 * foot.V_WF)
