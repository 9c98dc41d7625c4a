"""The weight shift of STEP: smooth, bounded, and a pendulum's motion."""

import numpy as np
import pytest

from atlas_drake.parts.step.weight_shift import (
    WeightShift,
    plan_weight_shift,
    sway_duration,
)
from atlas_drake.robot.soles import sole_corners
from atlas_drake.support_polygon import SupportPolygon

OMEGA = 3.2
DT = 1e-4
INSIDE = 0.01
SOLE = SupportPolygon(sole_corners(np.zeros(3), np.eye(3), 0.1, 0.05))


@pytest.fixture
def shift():
    return WeightShift(np.array([0.1, 0.0]), np.array([0.15, 0.2]), 1.3)


@pytest.mark.parametrize("time", [0.1, 0.6, 1.2])
def test_velocity_and_acceleration_are_derivatives(shift, time):
    (before, _, _), (p, v, a), (after, _, _) = map(
        shift.motion, (time - DT, time, time + DT)
    )
    np.testing.assert_allclose(v, (after - before) / (2.0 * DT), atol=1e-6)
    np.testing.assert_allclose(a, (after - 2.0 * p + before) / DT**2, atol=1e-5)


@pytest.mark.parametrize("time", [0.1, 0.6, 1.2])
def test_dcm_and_cop_are_those_of_one_pendulum(shift, time):
    now, later = shift.evaluate(time, OMEGA), shift.evaluate(time + DT, OMEGA)
    earlier = shift.evaluate(time - DT, OMEGA)
    rate = (later.dcm - earlier.dcm) / (2.0 * DT)
    np.testing.assert_allclose(rate, OMEGA * (now.dcm - now.cop), atol=1e-6)


@pytest.mark.parametrize("limit", [0.2, 0.8])
def test_the_least_duration_reaches_the_acceleration_and_no_more(limit):
    end = np.array([0.12, 0.16])
    duration = sway_duration(0.2, limit)
    shift = WeightShift(np.zeros(2), end, duration)
    times = np.linspace(0.0, duration, 2001)
    largest = max(np.hypot(*shift.motion(time)[2]) for time in times)
    assert largest == pytest.approx(limit, rel=1e-4)


def plan(dcm, end, least=0.3):
    return plan_weight_shift(np.array(dcm), np.array(end), least, SOLE, INSIDE, OMEGA)


def test_a_plan_starts_at_the_dcm_and_takes_no_more_time_than_it_needs():
    shift = plan([0.0, -0.001], [0.0, 0.001])
    np.testing.assert_allclose(shift.start, [0.0, -0.001])
    np.testing.assert_allclose(shift.end, [0.0, 0.001])
    assert shift.duration == 0.3


def test_a_plan_takes_the_time_that_keeps_its_cop_inside():
    dcm, end = [-0.05, -0.02], [0.05, 0.03]
    too_fast = WeightShift(np.array(dcm), np.array(end), 0.3)
    assert too_fast.cop_outside(SOLE, OMEGA) > 0.0
    shift = plan(dcm, end)
    times = np.linspace(0.0, shift.duration, 200)
    cops = [shift.evaluate(time, OMEGA).cop for time in times]
    outside = [SOLE.distance_outside(cop) for cop in cops]
    assert max(outside) < -0.8 * INSIDE
    assert shift.cop_outside(SOLE, OMEGA) == pytest.approx(max(outside), abs=0.002)
    # A fifth less would not have done.
    faster = WeightShift(shift.start, shift.end, 0.8 * shift.duration)
    assert faster.cop_outside(SOLE, OMEGA) > -INSIDE


def test_a_dcm_at_the_edge_is_led_inside_at_once():
    shift = plan([0.0, 0.06], [0.0, -0.02])
    assert -3.0 * INSIDE < SOLE.distance_outside(shift.start) <= -2.0 * INSIDE
    assert shift.start[0] == 0.0
    assert shift.duration < 1.5
