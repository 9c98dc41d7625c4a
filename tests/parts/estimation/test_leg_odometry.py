"""The filter on robots whose motion is known: standing, moving, stepping, hanging."""

import numpy as np
import pytest

from atlas_drake.control.attitude import (
    turn_between,
    turned,
)
from atlas_drake.frozen import replace
from atlas_drake.parts.estimation.leg_odometry import (
    OdometryTuning,
    correct,
    predict,
    slip_rate,
    start_odometry,
)
from atlas_drake.rotations import rotation_matrix
from atlas_drake.units import GRAVITY

DT = 0.002
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
P_WI = np.array([0.3, -0.2, 0.9])
FEET = np.array([[0.3, -0.1, 0.0], [0.3, -0.3, 0.0]])
BIAS = np.array([0.1, -0.1, 0.1])
"""Of the size that the reference IMU has [m/s²]."""
TUNING = OdometryTuning()
REST = np.zeros((2, 3))
BOTH, LEFT, NONE = np.array([0.5, 0.5]), np.array([1.0, 0.0]), np.zeros(2)


def start(velocity=(0.0, 0.0, 0.0), q=UPRIGHT):
    return start_odometry(q, P_WI, np.array(velocity), FEET, TUNING)


def rest(q=UPRIGHT, bias=(0.0, 0.0, 0.0)):
    """What the accelerometer of a robot at rest integrates in a tick."""
    return (rotation_matrix(q).T @ [0.0, 0.0, GRAVITY] + np.array(bias)) * DT


def stay(state, ticks, feet=FEET, load=BOTH, bias=(0.0, 0.0, 0.0)):
    """The filter after some ticks of a robot at rest with its feet there."""
    for _ in range(ticks):
        state = predict(state, np.zeros(3), rest(bias=bias), DT, TUNING)
        state = correct(state, feet - P_WI, REST, load, DT, TUNING)
    return state


def test_the_bias_is_known_in_the_pelvis_axes():
    q = turned(UPRIGHT, np.array([0.0, 0.0, 2.0]))
    state = stay(start(q=q), 1000, bias=BIAS)
    np.testing.assert_allclose(state.bias_P, BIAS, atol=3e-3)


def test_motion_under_exact_increments_is_followed_exactly():
    velocity, acceleration = np.array([0.2, 0.1, -0.1]), np.array([0.5, -1.0, 0.3])
    turn = np.array([0.1, 0.2, 0.9]) * DT
    state, q = start(velocity), UPRIGHT
    still = OdometryTuning(gravity_settling=np.inf)
    for k in range(1, 201):
        halfway = rotation_matrix(turned(q, 0.5 * turn))
        felt = halfway.T @ (acceleration + np.array([0.0, 0.0, GRAVITY])) * DT
        q, t = turned(q, turn), k * DT
        p_WI = P_WI + velocity * t + 0.5 * acceleration * t * t
        state = predict(state, turn, felt, DT, still)
        v_FI = np.tile(velocity + acceleration * t, (2, 1))
        state = correct(state, FEET - p_WI, -v_FI, BOTH, DT, still)
    np.testing.assert_allclose(state.p_WI, p_WI, atol=1e-9)
    np.testing.assert_allclose(state.v_WI, velocity + acceleration * t, atol=1e-9)
    np.testing.assert_allclose(state.p_WF, FEET, atol=1e-9)
    np.testing.assert_allclose(turn_between(q, state.q_WP), 0.0, atol=1e-12)


def test_a_foot_is_anchored_anew_where_it_lands():
    state, forward = start(), np.array([0.4, 0.0, 0.0])
    # Both feet are on the ground, the right one swings ahead, it lands, the left one
    # lifts: all of it on what kinematics alone says.
    swing = np.array([np.zeros(3), forward])
    for load, feet in (
        (BOTH, FEET),
        (LEFT, FEET + 0.5 * swing),
        (LEFT, FEET + swing),
        (BOTH, FEET + swing),
        (1.0 - LEFT, FEET + swing),
    ):
        state = stay(state, 50, feet, load)
        np.testing.assert_allclose(state.p_WI, P_WI, atol=1e-6)
        np.testing.assert_allclose(state.p_WF, feet, atol=1e-6)
    # Now it is the right foot that holds the pelvis.
    feet[0] += 1.0
    state = correct(state, feet - P_WI, REST, 1.0 - LEFT, DT, TUNING)
    np.testing.assert_allclose(state.p_WI, P_WI, atol=1e-6)
    np.testing.assert_allclose(state.p_WF, feet, atol=1e-6)


@pytest.mark.parametrize("speed", [0.15, 0.5])
def test_a_foot_that_slides_does_not_take_the_pelvis_along(speed):
    before = state = stay(start(), 500, bias=BIAS)
    # The stance foot slips by 15 mm, which the accelerometer does not feel.
    way, slide = 0.0, np.array([[0.0, speed, 0.0], [0.0, 0.0, 0.0]])
    while way < 0.015:
        way += speed * DT
        feet = FEET + way / speed * slide
        state = predict(state, np.zeros(3), rest(bias=BIAS), DT, TUNING)
        state = correct(state, feet - P_WI, slide, LEFT, DT, TUNING)
    state = stay(state, 300, feet, LEFT, BIAS)
    np.testing.assert_allclose(state.p_WI, before.p_WI, atol=2e-3)
    np.testing.assert_allclose(state.p_WF[0], feet[0], atol=2e-3)


def test_a_hanging_robot_does_not_fly_away():
    state = stay(start(), 2000, load=NONE, bias=BIAS)
    # The bias alone is 1.4 m in 4 s.
    assert np.linalg.norm(state.p_WI - P_WI) < 0.2
    np.testing.assert_allclose(state.v_WI, 0.0, atol=0.01)


def test_the_covariance_moves_on_as_the_mean_does():
    random = np.random.default_rng(2)
    root = random.normal(size=(5, 5))
    dt = 0.3  # So long that second-order terms count.
    felt = np.array([0.0, 0.0, GRAVITY * dt])
    before = replace(start(), covariance=root @ root.T)

    def moved(row, by):
        mean = before.mean.copy()
        mean[row, 0] += by
        return predict(replace(before, mean=mean), np.zeros(3), felt, dt, TUNING).mean

    # The mean is linear in what was believed: its rate of change is exact.
    rate = np.column_stack([moved(k, 0.5) - moved(k, -0.5) for k in range(5)])[:, ::3]
    noise = np.zeros((5, 5))
    noise[1, 1] = TUNING.acceleration**2 * dt
    after = predict(before, np.zeros(3), felt, dt, TUNING).covariance
    np.testing.assert_allclose(after, rate @ before.covariance @ rate.T + noise)


@pytest.mark.parametrize("period", [0.001, 0.004])
def test_the_period_does_not_decide_how_soon_the_bias_is_known(period):
    state = start()
    for _ in range(round(1.0 / period)):
        felt = (np.array([0.0, 0.0, GRAVITY]) + BIAS) * period
        state = predict(state, np.zeros(3), felt, period, TUNING)
        state = correct(state, FEET - P_WI, REST, BOTH, period, TUNING)
    np.testing.assert_allclose(state.bias_P, BIAS, atol=0.02)


@pytest.mark.parametrize("period", [0.001, 0.004])
def test_a_wrong_tilt_is_forgotten_at_its_rate(period):
    tuning = replace(TUNING, gravity_settling=2.0)
    state = start(q=turned(UPRIGHT, np.array([0.04, -0.03, 0.0])))
    for _ in range(round(1.0 / period)):
        felt = np.array([0.0, 0.0, GRAVITY]) * period
        state = predict(state, np.zeros(3), felt, period, tuning)
    left = np.exp(-0.5) * np.array([0.04, -0.03, 0.0])
    np.testing.assert_allclose(turn_between(UPRIGHT, state.q_WP), left, atol=2e-4)


def test_a_foot_drifts_the_more_the_less_it_carries_and_the_faster_it_moves():
    t = OdometryTuning()
    firm, loose = t.slip, t.slip + t.loose_slip
    assert (
        slip_rate(t.full_load, t.still, t)
        == slip_rate(1.0, 0.0, t)
        == pytest.approx(firm)
    )
    assert (
        slip_rate(t.no_load, 0.0, t) == slip_rate(-0.1, 9.0, t) == pytest.approx(loose)
    )
    assert (
        slip_rate(1.0, t.sliding, t) == slip_rate(1.0, 9.0, t) == pytest.approx(loose)
    )
    between = 0.5 * np.array([t.no_load + t.full_load, t.still + t.sliding])
    half = t.slip + 0.25 * t.loose_slip
    assert slip_rate(between[0], 0.0, t) == pytest.approx(half)
    assert slip_rate(1.0, between[1], t) == pytest.approx(half)
