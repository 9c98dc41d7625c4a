"""The sway of the centre of mass: smooth, bounded, and a pendulum's motion."""

import numpy as np
import pytest

from atlas_drake.control.com_sway import ComSway, sway_duration, sway_from_rest

OMEGA = 3.2
DT = 1e-4


@pytest.fixture
def sway():
    return ComSway(
        np.array([0.1, 0.0]),
        np.array([0.05, -0.02]),
        np.array([0.1, 0.2]),
        np.array([0.15, 0.2]),
        1.3,
    )


def test_begins_as_told_and_comes_to_rest_at_the_end(sway):
    p, v, a = sway.motion(0.0)
    np.testing.assert_allclose(p, sway.start)
    np.testing.assert_allclose(v, sway.velocity)
    np.testing.assert_allclose(a, sway.acceleration)
    for time in (sway.duration, 2.0 * sway.duration):
        p, v, a = sway.motion(time)
        np.testing.assert_allclose(p, sway.end, atol=1e-12)
        np.testing.assert_allclose([v, a], 0.0, atol=1e-9)


@pytest.mark.parametrize("time", [0.1, 0.6, 1.2])
def test_dcm_and_cop_are_those_of_one_pendulum(sway, time):
    now, later = sway.evaluate(time, OMEGA), sway.evaluate(time + DT, OMEGA)
    earlier = sway.evaluate(time - DT, OMEGA)
    rate = (later.dcm - earlier.dcm) / (2.0 * DT)
    np.testing.assert_allclose(rate, OMEGA * (now.dcm - now.cop), atol=1e-6)


@pytest.mark.parametrize("limit", [0.2, 0.8])
def test_the_least_duration_reaches_the_acceleration_and_no_more(limit):
    end = np.array([0.12, 0.16])
    duration = sway_duration(0.2, limit)
    sway = sway_from_rest(np.zeros(2), end, duration)
    times = np.linspace(0.0, duration, 2001)
    largest = max(np.hypot(*sway.motion(time)[2]) for time in times)
    assert largest == pytest.approx(limit, rel=1e-4)
