"""The swing foot: no jumps from lift-off to landing, even with a moved target."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.feet.footstep import way_around
from atlas_drake.control.feet.sole_motion import Pitch, pitch_from, pitched_pose
from atlas_drake.control.feet.swing_foot import SwingProfile, advance_swing, begin_swing
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.rotations import (
    rotation_vector,
    rotation_with_normal,
    rotation_z,
    wrap_angle,
    yaw_of,
)

DT = 0.002
DURATION = 0.5
PROFILE = SwingProfile()
FLAT = Pitch()
HALF_LENGTH = 0.13
LEVEL = 0.1
"""Height of the ground at lift-off [m]."""


@pytest.fixture
def start():
    return FootPose(np.array([0.3, 0.1, LEVEL]), rotation_z(0.4))


def step_to(x=0.7, y=0.2, z=LEVEL, yaw=0.9, swing_height=0.12):
    return Footstep(1, 0, np.array([x, y, z]), yaw, 0.7, swing_height)


def swing_through(
    start,
    target_at,
    ticks,
    dt=DT,
    duration=DURATION,
    pitch=FLAT,
    landing_pitch=0.0,
):
    """References of a swing whose target is a function of time."""
    swing = begin_swing(start, duration, HALF_LENGTH, pitch, landing_pitch)
    references = []
    for tick in range(ticks):
        swing, reference = advance_swing(swing, target_at(tick * dt), PROFILE, dt)
        references.append(reference)
    return swing, references


def stacked(references, name):
    return np.array([getattr(reference, name) for reference in references])


def assert_turning_is_consistent(references, **tolerance):
    """Angular velocity is that of the orientation, and acceleration that of it."""
    R, w = stacked(references, "R_WF"), stacked(references, "w_WF")
    for before, velocity, after in zip(R[:-2], w[1:-1], R[2:], strict=True):
        rate = rotation_vector(after @ before.T) / (2 * DT)
        np.testing.assert_allclose(velocity, rate, atol=5e-3)
    faster = (w[2:] - w[:-2]) / (2 * DT)
    alpha = stacked(references, "alpha_WF")[1:-1]
    np.testing.assert_allclose(off_apex(alpha), off_apex(faster), **tolerance)


def off_apex(values):
    """Values of all inner ticks but that of the apex, where the jerk jumps."""
    return np.delete(values, round(PROFILE.apex * DURATION / DT) - 2, axis=0)


SWING_TICKS = round(DURATION / DT) - 1
"""Ticks before the planned touchdown."""


@pytest.fixture(params=[0.0, 0.08, -0.08], ids=["level", "up", "down"])
def target(request):
    return step_to(z=LEVEL + request.param)


def test_lands_at_the_target_at_its_speed_over_its_apex(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    last = references[-1]
    np.testing.assert_allclose(last.p_WF[:2], target.p_WF[:2], atol=1e-3)
    assert last.p_WF[2] == pytest.approx(target.p_WF[2], abs=1e-3)
    downwards = [0.0, 0.0, -PROFILE.landing_speed]
    np.testing.assert_allclose(last.v_WF, downwards, atol=0.02)
    np.testing.assert_allclose(last.R_WF, rotation_z(target.yaw), atol=1e-2)
    np.testing.assert_allclose(last.w_WF, 0.0, atol=0.05)
    # The apex counts from the middle of the ends.
    highest = stacked(references, "p_WF")[:, 2].max()
    middle = 0.5 * (start.p_WF[2] + target.p_WF[2])
    assert highest - middle == pytest.approx(target.swing_height, abs=0.01)


@pytest.mark.parametrize("duration", [0.3, 1.0])
@pytest.mark.parametrize("swing_height", [0.03, 0.3])
def test_meets_the_ground_when_the_swing_is_over_and_not_before(
    start, target, duration, swing_height
):
    target = dataclasses.replace(target, swing_height=swing_height + 0.08)
    ticks = round(duration / DT)
    _, references = swing_through(start, lambda _: target, ticks + 1, duration=duration)
    above = stacked(references, "p_WF")[:, 2] - target.p_WF[2]
    # Just before, a foot that is a little low is not much too early.
    late = np.arange(1, ticks + 1) * DT > duration - 0.05
    left = duration - np.arange(1, ticks + 1) * DT
    speed = PROFILE.touchdown_speed(duration)
    assert (above[:ticks][late] > 0.6 * speed * left[late] - 1e-6).all()
    assert above[ticks - 1] == pytest.approx(0.0, abs=1e-6)
    assert above[ticks] == pytest.approx(-sunk_after(DT, duration), abs=1e-6)


def sunk_after(late, duration=DURATION):
    """Descent past the planned touchdown [m]."""
    speed = PROFILE.touchdown_speed(duration)
    return speed * late + 0.5 * PROFILE.late_acceleration * late**2


def test_a_short_swing_flies_low_and_lands_fast(start):
    target = step_to(swing_height=0.1)
    short = 0.5 * PROFILE.unhurried
    _, references = swing_through(
        start, lambda _: target, round(short / DT), duration=short
    )
    highest = stacked(references, "p_WF")[:, 2].max() - LEVEL
    assert 0.02 < highest < 0.045
    speed = -references[-1].v_WF[2]
    assert speed == pytest.approx(8.0 * PROFILE.landing_speed, rel=0.02)


def test_a_swing_that_is_hastened_sinks_smoothly(start):
    target = step_to(swing_height=0.1)
    swing, before = swing_through(start, lambda _: target, 100)
    swing = swing.landing_sooner(0.15)
    references = [before[-1]]
    for _ in range(round(swing.remaining / DT)):
        swing, reference = advance_swing(swing, target, PROFILE, DT)
        references.append(reference)
    z, vz, az = (stacked(references, name)[:, 2] for name in ("p_WF", "v_WF", "a_WF"))
    # At the instant of the change only the velocity may jump.
    assert np.abs(np.diff(z)).max() < 2.0 * DT
    middle = 0.5 * (vz[2:] + vz[1:-1])
    np.testing.assert_allclose(np.diff(z[1:]) / DT, middle, atol=0.02)
    middle = 0.5 * (az[2:] + az[1:-1])
    np.testing.assert_allclose((np.diff(vz[1:]) / DT)[:-1], middle[:-1], atol=0.5)


@pytest.mark.parametrize("at", [20, 100, 200])
def test_a_hastened_swing_lands_sooner_and_goes_on_where_it_is(start, target, at):
    swing, references = swing_through(start, lambda _: target, at)
    sooner = 0.4 * swing.remaining
    hastened = swing.landing_sooner(sooner)
    assert hastened.remaining == pytest.approx(swing.remaining - sooner)
    assert hastened.progress == pytest.approx(swing.progress)
    assert swing.landing_sooner(0.0) is swing
    _, following = advance_swing(hastened, target, PROFILE, DT)
    last = references[-1]
    reached = np.abs(last.v_WF).max() / 0.6 * DT + 1e-3
    np.testing.assert_allclose(following.p_WF, last.p_WF, atol=1.5 * reached)
    while hastened.remaining > DT:
        hastened, reference = advance_swing(hastened, target, PROFILE, DT)
    np.testing.assert_allclose(reference.p_WF, target.p_WF, atol=2e-3)


@pytest.mark.parametrize("climb", [0.1, -0.1])
def test_an_edge_between_the_ends_is_cleared(climb):
    reach, margin, half_sole = 0.32, 0.03, 0.13
    start = FootPose(np.array([0.0, 0.1, LEVEL]), np.eye(3))
    target = step_to(x=reach, y=0.1, z=LEVEL + climb, yaw=0.0, swing_height=0.13)
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    # The edge lies ahead of the toes going up, behind the heel going down.
    edge = half_sole + margin if climb > 0.0 else reach - half_sole - margin
    higher = LEVEL + max(climb, 0.0)
    for reference in references:
        for end in (-half_sole, half_sole):
            x, _, z = reference.p_WF + reference.R_WF @ [end, 0.0, 0.0]
            on_top = x > edge if climb > 0.0 else x < edge
            # Standing on the higher ground the sole begins to turn.
            assert not on_top or z > higher - 0.002


@pytest.mark.parametrize("begin_tilted", [True, False])
def test_the_sole_turns_to_the_normal_where_it_lands(begin_tilted):
    normal = np.array([0.1, -0.15, 0.0])
    normal[2] = np.sqrt(1.0 - normal @ normal)
    tilted = rotation_with_normal(0.4, normal)
    start = FootPose(np.zeros(3), tilted if begin_tilted else rotation_z(0.4))
    end = np.array([0.0, 0.0, 1.0]) if begin_tilted else normal
    target = dataclasses.replace(step_to(z=0.05), normal=end)
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    np.testing.assert_allclose(references[0].R_WF, start.R_WF, atol=1e-2)
    np.testing.assert_allclose(references[-1].R_WF, target.pose.R_WF, atol=1e-2)
    # With an angular velocity that is the orientation's own.
    assert_turning_is_consistent(references[:-5], rtol=0.2, atol=1.0)


def test_velocity_and_acceleration_are_derivatives(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS - 5)
    p, v, a = (stacked(references, name) for name in ("p_WF", "v_WF", "a_WF"))
    np.testing.assert_allclose((p[2:] - p[:-2]) / (2 * DT), v[1:-1], atol=2e-3)
    faster = (v[2:] - v[:-2]) / (2 * DT)
    np.testing.assert_allclose(off_apex(faster), off_apex(a[1:-1]), atol=0.4)
    assert_turning_is_consistent(references, atol=0.1)


def test_turns_the_short_way():
    start = FootPose(np.zeros(3), rotation_z(3.0))
    _, references = swing_through(start, lambda _: step_to(yaw=-3.0), SWING_TICKS)
    yaws = [yaw_of(reference.R_WF) for reference in references]
    # From 3.0 on over π to -3.0 there are 0.28 rad; the other way round 6.
    assert min(abs(yaw) for yaw in yaws) > 2.9
    assert wrap_angle(yaws[-1] + 3.0) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("moved_at", [0.1, 0.25, 0.4])
def test_a_target_moved_mid_swing_makes_no_jump(start, moved_at):
    before, after = step_to(), step_to(x=0.85, y=0.28, yaw=0.2)

    def target_at(time):
        return before if time < moved_at else after

    _, references = swing_through(start, target_at, SWING_TICKS)
    p, v, a = (stacked(references, n) for n in ("p_WF", "v_WF", "a_WF"))
    # Each tick goes on from the last with the velocities and accelerations given,
    # so that neither position nor velocity jumps.
    largest = np.abs(a).max()
    assert np.abs(np.diff(p, axis=0) - v[:-1] * DT).max() <= largest * DT**2
    assert np.abs(np.diff(v, axis=0)).max() <= 1.1 * largest * DT
    yaws = np.array([yaw_of(reference.R_WF) for reference in references])
    w, alpha = (stacked(references, n)[:, 2] for n in ("w_WF", "alpha_WF"))
    fastest = np.abs(alpha).max()
    assert np.abs(np.diff(yaws) - w[:-1] * DT).max() <= fastest * DT**2
    assert np.abs(np.diff(w)).max() <= 1.1 * fastest * DT
    # It ends where it was last told to.
    np.testing.assert_allclose(p[-1, :2], after.p_WF[:2], atol=5e-3)
    assert yaws[-1] == pytest.approx(after.yaw, abs=5e-3)
    moved = round(moved_at / DT)
    _, unmoved = swing_through(start, lambda _: before, SWING_TICKS)
    kept = stacked(unmoved, "p_WF")
    np.testing.assert_array_equal(p[:moved], kept[:moved])
    assert np.abs(p[moved] - kept[moved]).max() < 1e-3


def test_a_foot_that_finds_no_ground_goes_down_faster_and_faster(start, target):
    late_ticks = 50
    on_time = round(DURATION / DT)
    swing, references = swing_through(start, lambda _: target, on_time + late_ticks)
    p, v = stacked(references, "p_WF"), stacked(references, "v_WF")
    late = np.s_[on_time:]
    times = DT * np.arange(1, late_ticks + 1)
    np.testing.assert_allclose(
        v[late, 2], -PROFILE.landing_speed - PROFILE.late_acceleration * times
    )
    np.testing.assert_allclose(p[late, 2], target.p_WF[2] - sunk_after(times))
    np.testing.assert_array_equal(
        stacked(references, "a_WF")[late, 2], -PROFILE.late_acceleration
    )
    # Straight down, with neither slip nor turn.
    np.testing.assert_array_equal(v[late, :2], 0.0)
    np.testing.assert_array_equal(np.ptp(p[late, :2], axis=0), 0.0)
    np.testing.assert_allclose(stacked(references, "w_WF")[late], 0.0, atol=1e-12)
    assert swing.remaining == 0.0
    assert swing.progress == 1.0


def test_the_path_does_not_depend_on_the_tick(start, target):
    _, fine = swing_through(start, lambda _: target, 200, dt=0.001)
    _, coarse = swing_through(start, lambda _: target, 40, dt=0.005)
    for name in ("p_WF", "v_WF", "R_WF"):
        np.testing.assert_allclose(
            getattr(fine[-1], name), getattr(coarse[-1], name), atol=1e-9
        )


RAISED = Pitch(0.25, 3.0, 20.0)
"""Pitch of a foot that leaves the ground on its toes."""


@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_a_heel_that_is_up_comes_down_and_the_heel_lands_first(start, turn):
    target = step_to(yaw=0.4 + turn)
    _, references = swing_through(
        start, lambda _: target, SWING_TICKS, pitch=RAISED, landing_pitch=-0.1
    )
    first, last = references[0], references[-1]
    # At lift-off the toes are where they were.
    toes = [HALF_LENGTH, 0.0, 0.0]
    np.testing.assert_allclose(
        first.p_WF + first.R_WF @ toes, start.p_WF + start.R_WF @ toes, atol=2e-3
    )
    landing = FootPose(last.p_WF, last.R_WF)
    assert pitch_from(landing, target.normal) == pytest.approx(-0.1, abs=2e-3)
    flat = pitched_pose(landing, 0.1, -HALF_LENGTH)
    np.testing.assert_allclose(flat.p_WF, target.p_WF, atol=2e-3)
    # Velocities and accelerations are those of the path, but where jerks jump.
    p, v, a = (stacked(references, name) for name in ("p_WF", "v_WF", "a_WF"))
    np.testing.assert_allclose((p[2:] - p[:-2]) / (2 * DT), v[1:-1], atol=6e-3)
    faster = (v[2:] - v[:-2]) / (2 * DT)
    down = round(PROFILE.heel_down * DURATION / DT) - 2
    smooth = np.delete(np.arange(len(faster)), [down - 1, down, down + 1])
    np.testing.assert_allclose(
        off_apex(faster[smooth]), off_apex(a[1:-1][smooth]), atol=1.5
    )


def test_a_flat_swing_lands_flat(start, target):
    _, references = swing_through(start, lambda _: target, SWING_TICKS)
    landing = FootPose(references[-1].p_WF, references[-1].R_WF)
    assert pitch_from(landing, target.normal) == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("turn", [-0.5, 0.0, 0.5])
@pytest.mark.parametrize("foot", [0, 1])
def test_a_foot_passes_a_stance_foot_that_has_turned(foot, turn):
    """As in a stride after a turn: the straight way would cross its leg."""
    least, length, side = 0.16, 0.2, 1.0 - 2.0 * foot
    stance = FootPose(np.array([0.0, 0.0, LEVEL]), rotation_z(turn))
    start = FootPose(np.array([-0.45, side * 0.2, LEVEL]), np.eye(3))
    end = stance.R_WF @ [0.40, side * 0.2, 0.0] + stance.p_WF
    step = Footstep(1, foot, end, turn, 0.7, 0.1)
    around = way_around(step, start, stance, least, length)
    swing = begin_swing(start, DURATION, HALF_LENGTH, around=around)
    before = swing.xy
    for _ in range(round(DURATION / DT)):
        swing, reference = advance_swing(swing, step, PROFILE, DT)
        moved = (reference.p_WF[:2] - before) / DT
        mean = (reference.v_WF - 0.5 * DT * reference.a_WF)[:2]
        np.testing.assert_allclose(moved, mean, atol=0.02)
        before = reference.p_WF[:2]
        p_SF = stance.R_WF.T @ (reference.p_WF - stance.p_WF)
        if abs(p_SF[0]) < 0.5 * length:
            assert side * p_SF[1] > least - 0.01
    np.testing.assert_allclose(reference.p_WF[:2], end[:2], atol=1e-3)
    # It goes around a foot that has turned into its way, and straight on otherwise.
    assert bool(around.any()) == (side * turn < 0.0)


def test_a_foot_that_begins_beside_the_other_goes_straight():
    stance = FootPose(np.zeros(3), np.eye(3))
    for begin in (-0.01, 0.01):
        start = FootPose(np.array([begin, 0.12, 0.0]), np.eye(3))
        step = Footstep(1, 0, np.array([0.4, 0.2, 0.0]), 0.0, 0.7, 0.1)
        assert not way_around(step, start, stance, 0.16, 0.2).any()
