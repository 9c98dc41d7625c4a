"""Step adjustment: none for small errors, sufficient for large ones, symmetric."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from atlas_drake.control.balance.feedback import StepAdjustmentLimits, step_shift
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.rotations import rotation_z

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
