"""A sole pitches about its toes or its heel, and the strip there carries load."""

import numpy as np
import pytest

from atlas_drake.control.feet.foot_roll import FootRoll, falling, rising
from atlas_drake.control.feet.sole import toe_corners
from atlas_drake.control.feet.sole_motion import (
    Pitch,
    SoleMotion,
    pitch_from,
    pitched_pose,
)
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import rotation_vector, rotation_z

HALF_LENGTH, HALF_WIDTH = 0.13, 0.06
FLAT = FootPose(np.array([0.2, -0.1, 0.05]), rotation_z(0.6))
DT = 1e-4


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.6])
def test_toes_stay_and_the_heel_rises(angle):
    pose = pitched_pose(FLAT, angle, HALF_LENGTH)
    front = np.array([HALF_LENGTH, 0.0, 0.0])
    toes, before = (p.p_WF + p.R_WF @ front for p in (pose, FLAT))
    np.testing.assert_allclose(toes, before, atol=1e-12)
    heel = pose.p_WF - pose.R_WF @ front
    rise = 2.0 * HALF_LENGTH * np.sin(angle)
    assert heel[2] - FLAT.p_WF[2] == pytest.approx(rise)


def test_the_pitch_of_a_pose_is_found_again():
    for angle in (-0.2, 0.0, 0.4):
        pose = pitched_pose(FLAT, angle, HALF_LENGTH)
        assert pitch_from(pose, FLAT.R_WF[:, 2]) == pytest.approx(angle)


@pytest.mark.parametrize("edge", [HALF_LENGTH, -HALF_LENGTH, 0.0])
def test_the_pitched_motion_of_a_moving_sole_is_a_motion(edge):
    w, alpha = np.array([0.0, 0.0, 0.7]), np.array([0.0, 0.0, -0.9])
    v, a = np.array([0.4, -0.2, 0.3]), np.array([1.0, 0.5, -2.0])

    def at(t):
        flat = SoleMotion(
            p_WF=FLAT.p_WF + v * t + 0.5 * a * t * t,
            v_WF=v + a * t,
            a_WF=a,
            R_WF=rotation_z(0.7 * t - 0.45 * t * t) @ FLAT.R_WF,
            w_WF=w + alpha * t,
            alpha_WF=alpha,
        )
        pitch = Pitch(0.3 + 0.5 * t + 0.4 * t * t, 0.5 + 0.8 * t, 0.8)
        return flat.pitched(pitch, edge)

    before, now, after = at(-DT), at(0.0), at(DT)
    velocity = (after.p_WF - before.p_WF) / (2 * DT)
    np.testing.assert_allclose(now.v_WF, velocity, atol=1e-6)
    acceleration = (after.v_WF - before.v_WF) / (2 * DT)
    np.testing.assert_allclose(now.a_WF, acceleration, atol=1e-6)
    turning = rotation_vector(after.R_WF @ before.R_WF.T) / (2 * DT)
    np.testing.assert_allclose(now.w_WF, turning, atol=1e-6)
    angular_acceleration = (after.w_WF - before.w_WF) / (2 * DT)
    np.testing.assert_allclose(now.alpha_WF, angular_acceleration, atol=1e-6)


@pytest.mark.parametrize("evaluate", [rising, falling])
def test_a_pitch_rises_and_falls_without_a_jump(evaluate):
    duration, dt = 0.15, 1e-6
    for time in (0.01, 0.08, 0.14):
        before, now, after = (
            np.array(evaluate(0.2, duration, time + step)) for step in (-dt, 0.0, dt)
        )
        slope = (after - before) / (2 * dt)
        np.testing.assert_allclose(now[1:], slope[:2], rtol=1e-5)
    still = evaluate(0.2, duration, duration + 0.01)
    assert still == Pitch(0.2 if evaluate is rising else 0.0)


def test_the_soles_pitch_on_level_ground_ahead_only():
    roll = FootRoll()

    def share(ahead, aside=0.2, up=0.0):
        way = FLAT.R_WF @ [ahead, aside, up]
        return roll.share(FLAT, FootPose(FLAT.p_WF + way, FLAT.R_WF))

    assert share(roll.full_stride) == share(0.6) == pytest.approx(1.0)
    assert share(0.0) == share(-0.3) == 0.0
    assert share(roll.shortest_stride) == pytest.approx(0.0, abs=1e-9)
    half = 0.5 * (roll.shortest_stride + roll.full_stride)
    assert share(half) == pytest.approx(0.5)
    assert share(0.3, up=2.0 * roll.level) == 0.0


def test_on_stairs_the_lower_sole_is_on_its_toes():
    roll = FootRoll()

    def at(up, ahead=0.3):
        return FootPose(FLAT.p_WF + [0.0, 0.0, up] + ahead * FLAT.R_WF[:, 0], FLAT.R_WF)

    pitch = roll.climb * (0.15 - roll.easy_climb)
    assert 0.2 < pitch < roll.most_climb
    # It leaves a step up, and lands a step down, whatever comes next.
    assert roll.leaving(FLAT, at(0.15)) == pytest.approx(pitch)
    assert roll.landing(FLAT, at(-0.15), None) == pytest.approx(pitch)
    assert roll.landing(FLAT, at(-0.15), at(-0.3, 0.6)) == pytest.approx(pitch)
    assert roll.leaving(FLAT, at(0.5)) == roll.most_climb
    # The higher sole stays flat.
    assert roll.leaving(FLAT, at(-0.15)) == roll.landing(FLAT, at(0.15), None) == 0.0
    # On level ground it lands on its heel, unless the walk is about to stop.
    assert roll.landing(FLAT, at(0.0), at(0.0, 0.6)) == -roll.heel_first
    assert roll.landing(FLAT, at(0.0), None) == 0.0


def test_the_strip_that_carries_lies_at_the_front():
    toes = 0.03
    corners = toe_corners(FLAT, HALF_LENGTH, HALF_WIDTH, toes) - FLAT.p_WF
    corners = corners @ FLAT.R_WF
    assert corners[:, 0].max() == pytest.approx(HALF_LENGTH)
    assert corners[:, 0].min() == pytest.approx(HALF_LENGTH - toes)
    assert np.ptp(corners[:, 1]) == pytest.approx(2.0 * HALF_WIDTH)
