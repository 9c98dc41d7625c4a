"""The walk's DCM plan: the CoP over the stance feet, phase by phase, and to rest."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.gait import (
    begun_at,
    landing_sensitivity,
    plan_walk,
    stance_cop,
)
from atlas_drake.control.balance.dcm_plan import Pendulum
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.swing_foot import advance_swing, begin_swing
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import SupportPolygon

PENDULUM = Pendulum(3.3, (-0.006, -0.005))
CONFIG = WalkConfig(cop_inward=0.010)
TIMING = CONFIG.timing
INWARD = 0.010
"""Distance of the CoP from the middle of the stance sole [m]."""
FIRST = 0.37
"""Time left in the first phase [s]."""
WIDTH = 0.23
"""Between the soles' middles [m]."""


@pytest.fixture
def feet():
    return tuple(
        FootPose(np.array([0.0, outward(foot) * WIDTH / 2, 0.0]), np.eye(3))
        for foot in (LEFT, RIGHT)
    )


@pytest.fixture
def steps():
    """Three steps ahead, durations all different."""
    return tuple(
        Footstep(
            index=number,
            foot=foot,
            p_WF=np.array([0.25 * number, outward(foot) * WIDTH / 2, 0.0]),
            yaw=0.1 * number,
            duration=0.6 + 0.05 * number,
            swing_height=0.1,
        )
        for number, foot in enumerate((LEFT, RIGHT, LEFT), 1)
    )


@pytest.fixture
def cop():
    return np.array([0.01, -0.02])


def phases(first, steps, swinging):
    """Durations of all phases as (kind, step, duration)."""
    sequence = []
    for number, step in enumerate(steps):
        if not (number == 0 and swinging):
            sequence.append(("transfer", step, TIMING.transfer(step.duration)))
        sequence.append(("swing", step, TIMING.swing(step.duration)))
    sequence.append(("settle", None, TIMING.settle))
    kind, step, _ = sequence[0]
    sequence[0] = (kind, step, first)
    return sequence


def with_times(sequence):
    ends = itertools.accumulate(duration for *_, duration in sequence)
    for (kind, step, duration), end in zip(sequence, ends, strict=True):
        yield kind, step, end - duration, end


def test_a_step_takes_its_duration():
    assert TIMING.transfer(0.8) == pytest.approx(TIMING.transfer_share * 0.8)
    assert TIMING.transfer(0.8) + TIMING.swing(0.8) == pytest.approx(0.8)


@pytest.mark.parametrize("swinging", [False, True])
def test_in_single_support_the_cop_is_under_the_stance_foot(feet, steps, cop, swinging):
    in_air = begin_swing(feet[steps[0].foot], FIRST) if swinging else None
    plan = plan_walk(cop, FIRST, feet, steps, in_air, CONFIG, PENDULUM)
    poses = list(feet)
    sequence = phases(FIRST, steps, swinging)
    for number, (kind, step, start, end) in enumerate(with_times(sequence)):
        if kind != "swing":
            continue
        under = stance_cop(poses, step, CONFIG)
        np.testing.assert_allclose(plan.evaluate(end - 1e-9).cop, under, atol=1e-6)
        if number > 0 or not swinging:
            for share in (0.01, 0.5, 0.99):
                now = plan.evaluate(start + share * (end - start)).cop
                np.testing.assert_allclose(now, under, atol=1e-9)
        poses[step.foot] = step.pose


@pytest.mark.parametrize("swinging", [False, True])
@pytest.mark.parametrize("count", [0, 3])
def test_the_plan_ends_at_rest_between_the_feet(feet, steps, cop, swinging, count):
    taken = steps[:count]
    in_air = begin_swing(feet[steps[0].foot], FIRST) if swinging and count else None
    plan = plan_walk(cop, FIRST, feet, taken, in_air, CONFIG, PENDULUM)
    poses = list(feet)
    for step in taken:
        poses[step.foot] = step.pose
    middle = 0.5 * (poses[LEFT].p_WF + poses[RIGHT].p_WF)[:2]
    end = plan.evaluate(plan.duration)
    np.testing.assert_allclose(end.cop, middle, atol=1e-12)
    np.testing.assert_allclose(end.dcm, middle, atol=1e-12)


def test_replanning_midway_gives_the_same_plan(feet, steps, cop):
    # Where the plan comes from must not matter: the same future, the same DCM.
    plan = plan_walk(cop, FIRST, feet, steps, None, CONFIG, PENDULUM)
    passed = 0.6 * FIRST
    now = plan.evaluate(passed)
    again = plan_walk(now.cop, FIRST - passed, feet, steps, None, CONFIG, PENDULUM)
    duration = TIMING.swing(steps[0].duration)
    motion = begin_swing(feet[steps[0].foot], duration)
    for _ in range(40):
        motion, _ = advance_swing(motion, steps[0], CONFIG.swing, 0.01 * duration)
    into_swing = FIRST + motion.elapsed
    there = plan.evaluate(into_swing)
    in_air = plan_walk(there.cop, duration, feet, steps, motion, CONFIG, PENDULUM)
    for time in np.linspace(0.0, plan.duration - into_swing, 50):
        expected = plan.evaluate(into_swing + time)
        for other, start in ((again, into_swing - passed), (in_air, motion.elapsed)):
            now = other.evaluate(start + time)
            np.testing.assert_allclose(now.dcm, expected.dcm, atol=1e-9)
            np.testing.assert_allclose(now.cop, expected.cop, atol=1e-9)
            np.testing.assert_allclose(now.cmp, expected.cmp, atol=1e-6)


def test_the_leg_in_the_air_pushes_the_cmp_away_from_its_acceleration(feet, steps, cop):
    duration = TIMING.swing(steps[0].duration)
    motion = begin_swing(feet[steps[0].foot], duration)
    plan = plan_walk(cop, duration, feet, steps, motion, CONFIG, PENDULUM)
    for _ in range(98):
        motion, _ = advance_swing(motion, steps[0], CONFIG.swing, 0.01 * duration)
        now = plan.evaluate(motion.elapsed)
        expected = PENDULUM.swing_inertia * motion.xy_acceleration
        np.testing.assert_allclose(now.offset, expected, atol=1e-4)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
@pytest.mark.parametrize("yaw", [0.0, 0.8, -2.0])
def test_the_stance_cop_is_moved_inward_and_turns_with_the_foot(foot, yaw):
    middle = np.array([1.0, 2.0, 0.3])

    def shift(yaw, start, end):
        """The shift in a step of the other foot from one height to another."""
        stance = FootPose(middle, rotation_z(yaw))
        feet = [FootPose(middle + np.array([0.0, 0.0, start]), np.eye(3))] * 2
        feet[foot] = stance
        goal = middle + np.array([0.0, 0.0, end])
        step = Footstep(1, 1 - foot, goal, 0.0, 0.63, 0.1)
        return stance_cop(feet, step, CONFIG) - middle[:2]

    level = shift(0.0, 0.0, 0.0)
    turned = rotation_z(yaw)[:2, :2] @ level
    np.testing.assert_allclose(shift(yaw, 0.0, 0.0), turned, atol=1e-12)
    # Towards the other foot.
    np.testing.assert_allclose(level, [0.0, -outward(foot) * INWARD], atol=1e-12)
    # On stairs toward the toes, by the higher of two steps.
    ahead = [shift(0.0, *heights)[0] for heights in ((-0.2, 0.2), (0.0, 0.2))]
    np.testing.assert_allclose(ahead, 0.2 * CONFIG.cop_up, atol=1e-12)
    ahead = [shift(0.0, *heights)[0] for heights in ((0.2, -0.2), (0.0, -0.2))]
    np.testing.assert_allclose(ahead, 0.2 * CONFIG.cop_down, atol=1e-12)


def test_a_plan_begins_at_the_present_dcm():
    feet = (
        FootPose(np.array([0.0, 0.1, 0.0]), np.eye(3)),
        FootPose(np.array([0.0, -0.1, 0.0]), np.eye(3)),
    )
    step = Footstep(1, 0, np.array([0.2, 0.1, 0.0]), 0.0, 0.63, 0.1)
    cop = np.array([0.005, -0.002])
    plan = plan_walk(cop, 0.8, feet, [step], None, WalkConfig(), PENDULUM)
    wide = SupportPolygon(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], dtype=float))
    begun = begun_at(plan, cop, wide)
    np.testing.assert_allclose(begun.evaluate(0.0).dcm, cop, atol=1e-12)
    np.testing.assert_allclose(begun.evaluate(0.0).cop, cop, atol=1e-12)
    # It ends its first phase as the plan does.
    for time in (0.8, 1.0, plan.duration):
        for name in ("dcm", "cop"):
            np.testing.assert_allclose(
                getattr(begun.evaluate(time), name),
                getattr(plan.evaluate(time), name),
                atol=1e-12,
            )
    # A small support bounds how far the CoP goes aside.
    small = SupportPolygon(0.05 * wide.vertices)
    bounded = begun_at(plan, cop, small)
    sideways = [bounded.evaluate(0.01 * k).cop[1] for k in range(41)]
    assert max(np.abs(sideways)) <= 0.05 + 1e-12


@pytest.mark.parametrize("axis", [0, 1])
def test_the_sensitivity_is_the_derivative_by_the_landing_place(feet, steps, cop, axis):
    in_air = begin_swing(feet[steps[0].foot], FIRST)

    def dcm(shift):
        p_WF = steps[0].p_WF.copy()
        p_WF[axis] += shift
        coming = (replace(steps[0], p_WF=p_WF), *steps[1:])
        plan = plan_walk(cop, FIRST, feet, coming, in_air, CONFIG, PENDULUM)
        return plan.evaluate(FIRST).dcm[axis]

    found = landing_sensitivity(cop, FIRST, feet, steps, CONFIG, PENDULUM)
    assert found == pytest.approx((dcm(1e-3) - dcm(-1e-3)) / 2e-3, rel=1e-3)
    assert 0.5 < found < 1.0
