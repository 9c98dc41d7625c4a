"""Step adjustment: none for small errors, sufficient for large ones, symmetric."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atlas_drake.config import LeastGreatest
from atlas_drake.control.balance.step_adjustment import (
    SingleSupportState,
    StepAdjustmentLimits,
    place_for_balance,
    step_shift,
    touchdown_for_balance,
    within_reach,
)
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, FootPose, Footstep
from atlas_drake.rotations import rotation_z

LIMITS = StepAdjustmentLimits()
OMEGA = 3.2
SENSITIVITY = 0.8
"""Planned DCM at touchdown per metre that the foot moves [-]."""

ERRORS = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)).map(np.array)
TIMES = st.floats(0.0, 1.0)
YAWS = st.floats(-4.0, 4.0)


def shift_of(error, remaining, yaw=0.0, sensitivity=SENSITIVITY):
    stance = FootPose(np.array([0.4, 0.1, 0.0]), rotation_z(yaw))
    return step_shift(error, remaining, OMEGA, sensitivity, stance, LIMITS)


def taken_by_ankles(remaining):
    """DCM error now that ankles and double support take up, along and across [m]."""
    growth = math.exp(OMEGA * remaining)
    ankles = np.array([LIMITS.cop_forward, LIMITS.cop_sideways]) * (growth - 1.0)
    tolerated = np.array([LIMITS.tolerated_forward, LIMITS.tolerated_sideways])
    return (ankles + tolerated) / growth


@given(error=ERRORS, remaining=TIMES, yaw=YAWS)
def test_shift_turns_with_the_stance_foot(error, remaining, yaw):
    R_WS = rotation_z(yaw)[:2, :2]
    np.testing.assert_allclose(
        shift_of(R_WS @ error, remaining, yaw),
        R_WS @ shift_of(error, remaining),
        atol=1e-9,
    )


@given(error=ERRORS, remaining=TIMES, sensitivity=st.sampled_from([0.5, 0.8, 2.0]))
def test_with_ankles_and_tolerance_the_shift_makes_up_for_the_error(
    error, remaining, sensitivity
):
    shift = shift_of(error, remaining, sensitivity=sensitivity)
    growth = math.exp(OMEGA * remaining)
    budget = taken_by_ankles(remaining) * growth
    left = error * growth - sensitivity * shift
    assert (np.abs(left) <= budget + 1e-9).all()
    # No more than needed, and in the direction of the error.
    moved = shift != 0.0
    toward = np.sign(error[moved])
    np.testing.assert_allclose(toward * left[moved], budget[moved], atol=1e-9)


STANCE = FootPose(np.array([0.0, -0.1, 0.0]), np.eye(3))
STEP = Footstep(1, LEFT, np.array([0.25, 0.15, 0.0]), 0.0, 0.63, 0.1)
PLANNED, COP = np.array([0.08, -0.05]), np.array([0.0, -0.09])
"""Of the plan now: its DCM, and its CoP until touchdown [m]."""
REMAINING = 0.3
SOLE = (0.26, 0.12)


def state_with(error):
    return SingleSupportState(
        PLANNED + error, PLANNED, COP, OMEGA, REMAINING, SENSITIVITY, STANCE, SOLE
    )


def touchdown(error, progress=0.2, adjustment=LIMITS, foot=(0.0, 0.15), **limits):
    step, remaining, _ = touchdown_for_balance(
        STEP,
        state_with(np.array(error)),
        progress,
        np.array(foot),
        adjustment,
        StepLimits(**limits),
    )
    return step, remaining


def test_the_error_at_another_time_is_that_of_the_plan_reaching_touchdown_then():
    error = np.array([0.03, 0.01])
    state = state_with(error)
    np.testing.assert_allclose(state.error(REMAINING), error, atol=1e-12)

    def at_touchdown(dcm, remaining):
        return COP + math.exp(OMEGA * remaining) * (dcm - COP)

    for sooner in (0.1, 0.25):
        planned = at_touchdown(PLANNED, REMAINING)
        reached = at_touchdown(PLANNED + error, sooner)
        growth = math.exp(OMEGA * sooner)
        np.testing.assert_allclose(
            state.error(sooner) * growth, reached - planned, atol=1e-12
        )


def test_a_small_error_changes_neither_place_nor_time():
    step, remaining = touchdown([0.01, 0.005])
    assert step is STEP
    assert remaining == REMAINING


@pytest.mark.parametrize("error", [(0.2, 0.0), (0.0, -0.25)])
def test_an_error_out_of_reach_hastens_the_swing(error):
    step, remaining = touchdown(error)
    earliest = 0.8 * LIMITS.shortest_swing
    assert earliest <= remaining < REMAINING
    assert step.p_WF[0] <= 0.42 + 1e-12
    # Late in the swing there is less to win.
    _, late = touchdown(error, progress=0.9)
    assert late <= remaining


def test_a_push_over_the_stance_foot_crosses_the_legs_ahead_of_it():
    step, _ = touchdown([0.0, -0.12], foot=(0.25, 0.15))
    ahead, left, _ = step.p_WF - STANCE.p_WF
    assert ahead >= SOLE[0] + LIMITS.clearance - 1e-12
    assert -LIMITS.crossing <= left < 0.0
    uncrossed = replace(LIMITS, crossing=0.0)
    assert touchdown([0.0, -0.12], adjustment=uncrossed)[0].p_WF[1] >= STANCE.p_WF[1]
    # From beside the stance foot the way would lead over it.
    step, _ = touchdown([0.0, -0.12], foot=(0.0, 0.15))
    assert step.p_WF[1] > STANCE.p_WF[1]


@given(error=ERRORS, yaw=YAWS)
def test_soles_never_overlap(error, yaw):
    stance = replace(STANCE, R_WF=rotation_z(yaw))
    state = replace(state_with(error), stance=stance)
    there = replace(STEP, p_WF=STEP.p_WF + np.append(error, 0.0), yaw=yaw)
    foot = np.array([0.0, 0.15])
    step = place_for_balance(there, state, foot, LIMITS, StepLimits())
    ahead, left, _ = stance.R_WF.T @ (step.p_WF - stance.p_WF)
    length, width = SOLE
    gap = max(abs(ahead) - length, abs(left) - width)
    assert gap >= LIMITS.clearance - 1e-9


def test_within_reach_haste_is_weighed_against_the_shift_that_it_saves():
    (far, late), (near, soon) = (
        touchdown([0.12, 0.0], adjustment=replace(LIMITS, shift_cost=cost), forward=0.9)
        for cost in (0.0, 2.0)
    )
    assert late == REMAINING
    assert soon < late
    assert 0.25 <= near.p_WF[0] < far.p_WF[0]


def test_a_swing_is_hastened_the_less_the_more_haste_costs():
    times = [
        touchdown([0.2, 0.0], adjustment=replace(LIMITS, haste_cost=cost))[1]
        for cost in (0.0, 0.5, 50.0)
    ]
    assert times == sorted(times)
    assert times[0] < times[-1] == REMAINING


def test_a_foot_far_from_its_place_is_not_hastened_beyond_its_speed():
    _, remaining = touchdown([0.2, 0.0], progress=0.99)
    way = math.hypot(0.42, 0.0)
    assert remaining >= 0.9 * way / LIMITS.foot_speed


def test_a_step_for_balance_may_be_longer_but_stays_in_reach_of_the_legs():
    limits = StepLimits(forward=0.4, width=LeastGreatest(0.18, 0.5))
    wide = limits.extended(LIMITS.stretch)
    assert wide.forward == pytest.approx(0.4 + LIMITS.stretch)
    assert wide.width == pytest.approx((0.18, 0.5 + LIMITS.stretch))
    assert limits.extended(0.0, 0.02).width == pytest.approx((0.16, 0.5))
    far = Footstep(1, LEFT, np.array([0.5, 0.5, 0.02]), 0.0, 0.63, 0.1)
    near = within_reach(far, STANCE, 0.6)
    ahead = near.p_WF - STANCE.p_WF
    assert np.hypot(*ahead[:2]) == pytest.approx(0.6)
    assert ahead[0] / ahead[1] == pytest.approx(0.5 / 0.6)
    assert near.p_WF[2] == 0.02
    assert within_reach(STEP, STANCE, 0.6) is STEP
