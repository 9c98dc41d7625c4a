"""Toe-off: the toes stay in place and carry load while the heel rises."""

import numpy as np
import pytest

from atlas_drake.control.feet.sole import TOES, on_toes, toe_corners, toe_off_reference
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import rotation_vector, rotation_z

HALF_LENGTH, HALF_WIDTH = 0.13, 0.06
FLAT = FootPose(np.array([0.2, -0.1, 0.05]), rotation_z(0.6))
DT = 1e-4


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.6])
def test_toes_stay_and_the_heel_rises(angle):
    pose = on_toes(FLAT, angle, HALF_LENGTH)
    front = np.array([HALF_LENGTH, 0.0, 0.0])
    toes, before = (p.p_WF + p.R_WF @ front for p in (pose, FLAT))
    np.testing.assert_allclose(toes, before, atol=1e-12)
    heel = pose.p_WF - pose.R_WF @ front
    rise = 2.0 * HALF_LENGTH * np.sin(angle)
    assert heel[2] - FLAT.p_WF[2] == pytest.approx(rise)


def test_the_reference_is_a_motion():
    def angle(t):
        return 0.3 + 0.5 * t + 0.4 * t * t

    def at(t):
        return toe_off_reference(FLAT, angle(t), 0.5 + 0.8 * t, 0.8, HALF_LENGTH)

    before, now, after = at(-DT), at(0.0), at(DT)
    velocity = (after.p_WF - before.p_WF) / (2 * DT)
    np.testing.assert_allclose(now.v_WF, velocity, atol=1e-6)
    acceleration = (after.v_WF - before.v_WF) / (2 * DT)
    np.testing.assert_allclose(now.a_WF, acceleration, atol=1e-6)
    turning = rotation_vector(after.R_WF @ before.R_WF.T) / (2 * DT)
    np.testing.assert_allclose(now.w_WF, turning, atol=1e-6)
    angular_acceleration = (after.w_WF - before.w_WF) / (2 * DT)
    np.testing.assert_allclose(now.alpha_WF, angular_acceleration, atol=1e-6)


def test_the_strip_that_carries_lies_at_the_front():
    corners = (toe_corners(FLAT, HALF_LENGTH, HALF_WIDTH) - FLAT.p_WF) @ FLAT.R_WF
    assert corners[:, 0].max() == pytest.approx(HALF_LENGTH)
    assert corners[:, 0].min() == pytest.approx(HALF_LENGTH - TOES)
    assert np.ptp(corners[:, 1]) == pytest.approx(2.0 * HALF_WIDTH)
