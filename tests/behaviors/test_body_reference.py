"""The reference of trunk and posture: present start, limited speed."""

import dataclasses

import numpy as np
import pytest
from pydrake.math import RollPitchYaw

from atlas_drake.behaviors.body_reference import (
    BodyRates,
    BodyTarget,
    advance_body,
    capture_body,
)
from atlas_drake.rotations import wrap_angle

DT = 0.01
RATES = BodyRates()


@pytest.fixture(scope="module")
def terms(model):
    """The robot with its trunk tilted and its joints anywhere."""
    random = np.random.default_rng(3)
    robot, context = model.robot, model.create_context()
    state = np.zeros(model.num_states)
    rotation = RollPitchYaw(0.2, -0.15, 2.5).ToQuaternion()
    state[:4] = rotation.wxyz()
    state[4:7] = [0.4, -0.3, 0.9]
    state[robot.indices(model.plant).q] = random.uniform(
        0.5 * robot.position_lower, 0.5 * robot.position_upper
    )
    return model.evaluate(context, state)


@pytest.fixture
def captured(terms):
    return capture_body(terms)


@pytest.fixture
def target(model):
    return BodyTarget(
        height=1.0,
        yaw=-2.9,
        joints=model.robot.stand_prep,
        pelvis_tilt=np.array([0.0, 0.1]),
        chest_tilt=np.array([0.0, 0.1]),
    )


@pytest.fixture
def nobody(model):
    return np.zeros(model.robot.num_joints, dtype=bool)


def advance(body, target, held, measured=None, steps=1):
    if measured is None:
        measured = np.zeros_like(body.joints)
    for _ in range(steps):
        body = advance_body(body, target, RATES, DT, measured, held)
    return body


def test_the_captured_reference_is_the_present_posture(terms, captured):
    np.testing.assert_allclose(captured.R_WP(0.0), terms.R_WP, atol=1e-12)
    assert captured.height == terms.com[2]
    assert captured.height_rate == captured.yaw_rate == 0.0
    np.testing.assert_array_equal(captured.joints, terms.q)
    # The chest keeps its tilt but heads as the pelvis.
    chest, was = RollPitchYaw(captured.R_WC), RollPitchYaw(terms.R_WC)
    assert chest.roll_angle() == pytest.approx(was.roll_angle())
    assert chest.pitch_angle() == pytest.approx(was.pitch_angle())
    assert chest.yaw_angle() == pytest.approx(captured.yaw)


@pytest.mark.parametrize("way", [1e-4, 0.01, 1.0])
def test_rates_change_by_a_bounded_acceleration_without_overshoot(
    captured, target, nobody, way
):
    goal = dataclasses.replace(
        target, height=captured.height - way, yaw=captured.yaw + way
    )
    body, most = captured, 0.0
    for _ in range(1500):
        after = advance(body, goal, nobody)
        for name, limit in (("height_rate", RATES.height), ("yaw_rate", RATES.yaw)):
            change = abs(getattr(after, name) - getattr(body, name))
            assert change <= limit * DT / RATES.easing + 1e-12
        most = max(most, after.yaw - goal.yaw, goal.height - after.height)
        body = after
    assert body.yaw == pytest.approx(goal.yaw, abs=1e-9)
    assert body.height == pytest.approx(goal.height, abs=1e-9)
    assert most < 1e-9, "it went too far"


def test_the_reference_reaches_its_target_and_stays(captured, target, nobody):
    body = advance(captured, target, nobody, steps=3000)
    assert body.height == pytest.approx(target.height)
    assert wrap_angle(body.yaw - target.yaw) == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(body.joints, target.joints)
    # Pelvis and chest both go to the tilt desired of the pelvis.
    np.testing.assert_allclose(body.pelvis_tilt, target.pelvis_tilt)
    np.testing.assert_allclose(body.chest_tilt, target.pelvis_tilt)
    after = advance(body, target, nobody)
    for field in dataclasses.fields(body):
        np.testing.assert_allclose(
            getattr(after, field.name), getattr(body, field.name), atol=1e-12
        )
    assert after.height_rate == pytest.approx(0.0, abs=1e-9)
    assert after.yaw_rate == pytest.approx(0.0, abs=1e-9)


def test_the_lead_follows_that_of_the_feet_exactly_and_closes_a_gap_slowly(
    captured, target, nobody
):
    rate = 2.0

    def goal(time):
        return dataclasses.replace(target, lead=0.1 + rate * time, lead_rate=rate)

    body, gap = captured, 0.1
    for tick in range(1, 200):
        before, body = body, advance(body, goal(tick * DT), nobody)
        np.testing.assert_allclose(body.lead - before.lead, body.lead_rate * DT)
        assert abs(body.lead_rate - rate) <= RATES.lead + 1e-9
        gap = max(gap - RATES.lead * DT, 0.0)
        assert goal(tick * DT).lead - body.lead == pytest.approx(gap, abs=1e-9)
    assert gap == 0.0
    # A behavior without feet that lead brings pelvis and arms back.
    body = advance(body, target, nobody, steps=2000)
    assert (body.lead, body.lead_rate) == (0.0, 0.0)


def test_the_pelvis_turns_from_the_heading(captured):
    turned = captured.R_WP(0.2)
    heading = RollPitchYaw(captured.R_WP(0.0)).yaw_angle()
    assert RollPitchYaw(turned).yaw_angle() == pytest.approx(heading + 0.2)


def test_the_reference_turns_the_short_way(captured, target, nobody):
    # From 2.5 to -2.9 rad the short way leads over π.
    after = advance(captured, target, nobody, steps=15)
    assert after.yaw > captured.yaw
    assert after.yaw_rate == pytest.approx(RATES.yaw)


def test_user_held_joints_follow_what_is_measured(model, captured, target):
    held = model.robot.limb("l_arm", "r_arm", "neck")
    measured = np.linspace(-1.0, 1.0, len(held))
    after = advance(captured, target, held, measured)
    np.testing.assert_array_equal(after.joints[held], measured[held])
    free = advance(captured, target, np.zeros_like(held), measured)
    np.testing.assert_array_equal(after.joints[~held], free.joints[~held])
    # Given back, they set off from where the user left them.
    back = advance(after, target, np.zeros_like(held), measured)
    assert np.abs(back.joints - after.joints).max() <= RATES.joints * DT + 1e-12


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.3, -0.2), (-0.1, 0.4)])
def test_orientation_is_roll_pitch_yaw(captured, tilt):
    body = dataclasses.replace(captured, yaw=0.7, pelvis_tilt=np.array(tilt))
    expected = RollPitchYaw(tilt[0], tilt[1], 0.7).ToRotationMatrix().matrix()
    np.testing.assert_allclose(body.R_WP(0.0), expected, atol=1e-14)
