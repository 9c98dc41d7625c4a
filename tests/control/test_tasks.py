"""Feedback laws of single tasks, and the center of pressure from wrenches."""

import numpy as np
import pytest

from atlas_drake.control.balance.feedback import (
    dcm,
    height_acceleration,
    pendulum_frequency,
)
from atlas_drake.control.gains import PdGains
from atlas_drake.control.wrenches import center_of_pressure
from atlas_drake.units import GRAVITY

GAINS = PdGains(kp=50.0, kd=8.0)


@pytest.fixture
def terms(model, random_state):
    return model.evaluate(model.create_context(), random_state(2))


def test_pendulum_frequency():
    assert pendulum_frequency(0.9) ** 2 * 0.9 == pytest.approx(GRAVITY)
    # Of a robot that lies on the ground, or below it, that of a very short one.
    assert pendulum_frequency(-0.1) ** 2 * 0.1 == pytest.approx(GRAVITY)


def test_dcm_is_the_com_and_its_velocity(terms):
    expected = terms.com[:2] + terms.com_velocity[:2] / 3.0
    np.testing.assert_allclose(dcm(terms, 3.0), expected)


def test_height_acceleration(terms):
    z, rate = terms.com[2], terms.com_velocity[2]
    assert height_acceleration(terms, z, rate, GAINS) == 0.0
    assert height_acceleration(terms, z + 0.1, rate, GAINS) == pytest.approx(5.0)
    assert height_acceleration(terms, z, rate + 0.1, GAINS) == pytest.approx(0.8)


def test_the_cop_is_the_loads_mean_shifted_by_the_moments():
    soles = np.array([[0.0, 0.1, 0.0], [0.3, -0.1, 0.2]])
    wrenches = np.zeros(12)
    assert center_of_pressure(soles, wrenches) is None
    wrenches[5] = wrenches[11] = 400.0
    np.testing.assert_allclose(center_of_pressure(soles, wrenches), [0.15, 0.0, 0.1])
    # The left foot alone, pressed 5 cm before and 2 cm left of its center.
    wrenches[11] = 0.0
    wrenches[:3] = np.cross([0.05, 0.02, 0.0], [0.0, 0.0, 400.0])
    np.testing.assert_allclose(center_of_pressure(soles, wrenches), [0.05, 0.12, 0.0])


def test_a_foot_that_barely_touches_has_no_cop():
    wrenches = np.zeros(12)
    for load, exists in ((19.0, False), (21.0, True)):
        wrenches[5] = load
        assert (center_of_pressure(np.zeros((2, 3)), wrenches) is not None) == exists
