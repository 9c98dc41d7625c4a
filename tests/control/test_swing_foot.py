"""The swinging foot: from lift-off to landing without jumps, also to a moved target."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.footstep import FootPose, Footstep
from atlas_drake.control.rotations import rotation_z, wrap_angle, yaw_of
from atlas_drake.control.swing_foot import SwingProfile, advance_swing, begin_swing

DT = 0.002
DURATION = 0.5
PROFILE = SwingProfile()
LEVEL = 0.1
"""Height of the ground at lift-off [m]."""


@pytest.fixture
def start():
    return FootPose(np.array([0.3, 0.1, LEVEL]), rotation_z(0.4))


def step_to(x=0.7, y=0.2, z=LEVEL, yaw=0.9, swing_height=0.12):
    return Footstep(1, 0, np.array([x, y, z]), yaw, 0.7, swing_height)


def swing_through(start, target_at, ticks, dt=DT, duration=DURATION):
    """References of a swing whose target is a function of time."""
    swing = begin_swing(start, duration)
    references = []
    for tick in range(ticks):
        swing, reference = advance_swing(swing, target_at(tick * dt), PROFILE, dt)
        references.append(reference)
    return swing, references


def stacked(references, name):
    return np.array([getattr(reference, name) for reference in references])


SWING_TICKS = round(DURATION / DT) - 1
"""Ticks before the planned touchdown."""


@pytest.fixture(params=[0.0, 0.08, -0.08], ids=["level", "up", "down"])
def target(request):
    return step_to(z=LEVEL + request.param)


def test_lifts_off_from_where_the_foot_is_at_rest(start, target):
    _, references = swing_through(start, lambda _: target, 1)
    first = references[0]
    np.testing.assert_allclose(first.p_WF, start.p_WF, atol=1e-3)
    np.testing.assert_allclose(first.v_WF, 0.0, atol=0.05)
    np.testing.assert_allclose(first.R_WF, start.R_WF, atol=1e-2)


def test_lands_at_the_target_at_rest(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    last = references[-1]
    np.testing.assert_allclose(last.p_WF[:2], target.p_WF[:2], atol=1e-3)
    assert last.p_WF[2] == pytest.approx(target.p_WF[2] - PROFILE.press_depth, abs=1e-3)
    np.testing.assert_allclose(last.v_WF, 0.0, atol=0.05)
    np.testing.assert_allclose(last.R_WF, rotation_z(target.yaw), atol=1e-2)
    np.testing.assert_allclose(last.w_WF, 0.0, atol=0.05)


def test_apex_clears_the_higher_end_by_the_swing_height(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    highest = stacked(references, "p_WF")[:, 2].max()
    clearance = highest - max(start.p_WF[2], target.p_WF[2])
    assert clearance >= target.swing_height - PROFILE.press_depth
    # Nor does it overshoot for nothing: half a step's rise shifts the apex a little.
    assert clearance <= target.swing_height + 0.02


def test_never_below_the_ground_on_the_way_up(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS // 2)
    heights = stacked(references, "p_WF")[:, 2]
    assert (np.diff(heights)[: SWING_TICKS // 4] > 0.0).all()


def test_velocity_and_acceleration_are_derivatives(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS - 5)
    p, v, a = (stacked(references, name) for name in ("p_WF", "v_WF", "a_WF"))
    np.testing.assert_allclose((p[2:] - p[:-2]) / (2 * DT), v[1:-1], atol=2e-3)
    np.testing.assert_allclose((v[2:] - v[:-2]) / (2 * DT), a[1:-1], atol=0.2)


def test_angular_velocity_is_that_of_the_orientation(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS - 5)
    R, w = stacked(references, "R_WF"), stacked(references, "w_WF")
    for k in range(1, len(R) - 1):
        W = (R[k + 1] - R[k - 1]) / (2 * DT) @ R[k].T
        rate = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
        np.testing.assert_allclose(w[k], rate, atol=5e-3)


def test_turns_the_short_way():
    start = FootPose(np.zeros(3), rotation_z(3.0))
    _, references = swing_through(start, lambda _: step_to(yaw=-3.0), SWING_TICKS)
    yaws = [yaw_of(reference.R_WF) for reference in references]
    # From 3.0 on over π to -3.0 there are 0.28 rad; the other way round 6.
    assert min(abs(yaw) for yaw in yaws) > 2.9
    assert wrap_angle(yaws[-1] + 3.0) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("moved_at", [0.1, 0.25, 0.4])
def test_a_target_moved_mid_swing_makes_no_jump(start, moved_at):
    before, after = step_to(), step_to(x=0.85, y=0.28)

    def target_at(time):
        return before if time < moved_at else after

    _, references = swing_through(start, target_at, SWING_TICKS)
    p, v, a = (stacked(references, n) for n in ("p_WF", "v_WF", "a_WF"))
    # Each tick goes on from the last with the velocities and accelerations given,
    # so that neither position nor velocity jumps.
    largest = np.abs(a).max()
    assert np.abs(np.diff(p, axis=0) - v[:-1] * DT).max() <= largest * DT**2
    assert np.abs(np.diff(v, axis=0)).max() <= 1.1 * largest * DT
    # It ends where it was last told to.
    np.testing.assert_allclose(p[-1, :2], after.p_WF[:2], atol=5e-3)
    moved = round(moved_at / DT)
    _, unmoved = swing_through(start, lambda _: before, SWING_TICKS)
    kept = stacked(unmoved, "p_WF")
    np.testing.assert_array_equal(p[:moved], kept[:moved])
    assert np.abs(p[moved] - kept[moved]).max() < 1e-3


def test_a_foot_that_finds_no_ground_goes_on_down(start, target):
    late_ticks = 50
    on_time = round(DURATION / DT)
    swing, references = swing_through(start, lambda _: target, on_time + late_ticks)
    p, v = stacked(references, "p_WF"), stacked(references, "v_WF")
    late = np.s_[on_time:]
    np.testing.assert_allclose(v[late, 2], -PROFILE.late_descent)
    np.testing.assert_allclose(np.diff(p[late, 2]), -PROFILE.late_descent * DT)
    assert p[-1, 2] == pytest.approx(
        target.p_WF[2] - PROFILE.press_depth - PROFILE.late_descent * late_ticks * DT
    )
    # Straight down, with neither slip nor turn.
    np.testing.assert_array_equal(v[late, :2], 0.0)
    np.testing.assert_array_equal(np.ptp(p[late, :2], axis=0), 0.0)
    np.testing.assert_allclose(stacked(references, "w_WF")[late], 0.0, atol=1e-12)
    assert swing.remaining == 0.0
    assert swing.progress == 1.0


def test_progress_and_remaining_count_the_swing(start):
    swing, _ = swing_through(start, lambda _: step_to(), 100)
    assert swing.elapsed == pytest.approx(100 * DT)
    assert swing.progress == pytest.approx(100 * DT / DURATION)
    assert swing.remaining == pytest.approx(DURATION - 100 * DT)


def test_the_path_does_not_depend_on_the_tick(start, target):
    _, fine = swing_through(start, lambda _: target, 200, dt=0.001)
    _, coarse = swing_through(start, lambda _: target, 40, dt=0.005)
    for name in ("p_WF", "v_WF", "R_WF"):
        np.testing.assert_allclose(
            getattr(fine[-1], name), getattr(coarse[-1], name), atol=1e-9
        )


def test_a_swing_is_a_value(start):
    swing = begin_swing(start, DURATION)
    kept = dataclasses.asdict(swing)
    advance_swing(swing, step_to(), PROFILE, DT)
    for name, value in dataclasses.asdict(swing).items():
        if name != "start":
            np.testing.assert_array_equal(value, kept[name])
