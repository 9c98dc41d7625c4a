"""Lift, move, lower: the path of a quasi-static step's foot."""

import numpy as np
import pytest

from atlas_drake.messages.footstep import FootPose
from atlas_drake.parts.step.swing_path import (
    PEAK_SPEED,
    SwingPathProfile,
    plan_swing_path,
)
from atlas_drake.rotations import (
    rotation_vector,
    rotation_with_normal,
    rotation_y,
    rotation_z,
)

PROFILE = SwingPathProfile()
DT = 0.001
LIFT, RISE, SPEED = 0.1, 0.04, 0.5
HOME = FootPose(np.array([0.3, 0.1, 0.05]), rotation_z(0.4))
NORMAL = np.array([0.15, -0.1, 1.0]) / np.linalg.norm([0.15, -0.1, 1.0])


def plan(dz=0.0, duration=0.1, speed=SPEED, start=HOME, normal=NORMAL, x=0.3):
    goal = FootPose(
        HOME.p_WF + np.array([x, 0.05, dz]), rotation_with_normal(0.9, normal)
    )
    return plan_swing_path(start, HOME, goal, LIFT, RISE, duration, speed, PROFILE)


def path(swing, end=None):
    times = np.arange(0.0, end or swing.duration, DT)
    return times, [swing.evaluate(time) for time in times]


def stacked(references, name):
    return np.array([getattr(reference, name) for reference in references])


@pytest.fixture(params=[0.0, 0.15, -0.15], ids=["level", "up", "down"])
def swing(request):
    return plan(dz=request.param)


def test_lifts_straight_up_before_it_moves_and_lowers_straight_down(swing):
    times, references = path(swing)
    p = stacked(references, "p_WF")
    lifting = times < swing.lift
    lowering = times >= swing.lift + swing.move
    np.testing.assert_array_equal(np.ptp(p[lifting, :2], axis=0), 0.0)
    np.testing.assert_array_equal(p[0], HOME.p_WF)
    np.testing.assert_array_equal(np.ptp(p[lowering, :2], axis=0), 0.0)
    np.testing.assert_array_equal(p[-1, :2], swing.goal.p_WF[:2])
    # At full lift height, above the higher foothold, for the whole way across.
    across = ~lifting & ~lowering
    higher = max(HOME.p_WF[2], swing.goal.p_WF[2])
    assert p[across, 2].min() == pytest.approx(higher + LIFT, abs=1e-6)
    assert p[:, 2].max() == pytest.approx(higher + LIFT + RISE, abs=1e-4)
    np.testing.assert_array_equal([swing.is_lowering(t) for t in times], lowering)


def test_velocity_and_acceleration_are_derivatives(swing):
    _, references = path(swing)
    p, v, a = (stacked(references, name) for name in ("p_WF", "v_WF", "a_WF"))
    np.testing.assert_allclose((p[2:] - p[:-2]) / (2 * DT), v[1:-1], atol=2e-3)
    np.testing.assert_allclose((v[2:] - v[:-2]) / (2 * DT), a[1:-1], atol=0.05)


def test_angular_velocity_and_acceleration_are_those_of_the_orientation(tipped):
    swing = plan(start=tipped)
    times, references = path(swing)
    R, w, alpha = (stacked(references, name) for name in ("R_WF", "w_WF", "alpha_WF"))
    for k in range(1, len(R) - 1):
        rate = rotation_vector(R[k + 1] @ R[k - 1].T) / (2 * DT)
        np.testing.assert_allclose(w[k], rate, atol=2e-3)
    # The acceleration jumps where lifting ends, and where moving across does.
    smooth = np.abs(times - swing.lift) > 2 * DT
    smooth &= np.abs(times - swing.lift - swing.move) > 2 * DT
    faster = (w[2:] - w[:-2]) / (2 * DT)
    np.testing.assert_allclose(
        faster[smooth[1:-1]], alpha[1:-1][smooth[1:-1]], atol=0.2
    )


def test_the_speed_is_bounded_and_the_duration_what_is_asked_beyond_that(swing):
    _, references = path(swing)
    speed = np.linalg.norm(stacked(references, "v_WF"), axis=1).max()
    assert 0.8 * SPEED < speed <= SPEED + 1e-6
    assert plan(duration=4.0).duration == pytest.approx(4.0)
    slower = plan(speed=0.5 * SPEED).duration
    assert slower == pytest.approx(2.0 * plan().duration, rel=0.05)


@pytest.fixture
def tipped():
    """A foot on its toes, its heel up."""
    return FootPose(HOME.p_WF + np.array([0.0, 0.0, 0.06]), HOME.R_WF @ rotation_y(0.5))


def test_a_foot_on_its_toes_is_flat_once_it_is_lifted(tipped):
    swing = plan(start=tipped)
    np.testing.assert_allclose(swing.evaluate(0.0).R_WF, tipped.R_WF, atol=1e-12)
    np.testing.assert_allclose(swing.evaluate(0.0).p_WF, tipped.p_WF, atol=1e-12)
    np.testing.assert_allclose(swing.evaluate(swing.lift).R_WF, HOME.R_WF, atol=1e-9)
    assert swing.top == pytest.approx(HOME.p_WF[2] + LIFT)


def test_a_late_foot_descends_to_a_bound(swing):
    ground = swing.goal.p_WF[2]
    shallow = swing.evaluate(swing.duration + 0.2)
    depth = PROFILE.press_depth + 0.2 * PROFILE.late_descent
    assert shallow.p_WF[2] == pytest.approx(ground - depth)
    assert shallow.v_WF[2] == -PROFILE.late_descent
    assert not swing.has_missed(swing.duration + 0.2)
    late = swing.duration + PROFILE.deepest / PROFILE.late_descent + 1e-6
    for time in (late, late + 5.0):
        assert swing.has_missed(time)
        deepest = swing.evaluate(time)
        depth = PROFILE.press_depth + PROFILE.deepest
        assert deepest.p_WF[2] == pytest.approx(ground - depth)
        np.testing.assert_array_equal(deepest.v_WF, 0.0)


def test_the_time_across_is_that_of_the_horizontal_way_with_turn_and_rise():
    swing = plan(dz=0.15, speed=0.2, normal=np.array([0.0, 0.0, 1.0]))
    across = np.linalg.norm([0.3, 0.05, PROFILE.turn_radius * 0.5, 2.0 * RISE])
    assert swing.move == pytest.approx(PEAK_SPEED * across / 0.2)
