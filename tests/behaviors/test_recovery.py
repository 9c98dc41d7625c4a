"""Steps that nobody commanded: when they are needed, and where they go."""

from types import SimpleNamespace

import numpy as np
import pytest

from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.recovery import Recovery
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phase import WalkTick
from atlas_drake.behaviors.walk.recovery_steps import (
    recovery_step,
    square_up_step,
)
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.behaviors.walk.transitions import keep_balance, make_swing
from atlas_drake.control.balance.dcm_plan import Pendulum
from atlas_drake.control.feet.footstep import outward
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep

PUSHED = 0.8
"""Speed of the robot after a push from which only a step saves it [m/s]."""
CONFIG = WalkConfig()
OMEGA = 3.3
FEET = tuple(FootPose(np.array([0.0, y, 0.05]), np.eye(3)) for y in (0.12, -0.12))


# ---- when --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("speed", "needed"), [(0.0, False), (0.2, False), (PUSHED, True), (-PUSHED, True)]
)
def test_a_step_is_needed_when_the_dcm_is_outside_the_soles(
    balance, observe, speed, needed
):
    recovery = Recovery(balance, StandConfig())
    assert recovery.is_needed(observe(speed=speed)) is needed


def test_no_step_is_made_with_a_users_leg_without_load_or_when_switched_off(
    balance, observe
):
    recovery = Recovery(balance, StandConfig())
    pushed = observe(speed=PUSHED)
    for users in ({"l_leg_kny": 0.1}, {"r_leg_akx": 1.0}):
        assert not recovery.is_needed(observe(speed=PUSHED, users=users))
    assert recovery.is_needed(observe(speed=PUSHED, users={"l_arm_elx": 1.0}))
    for force in (np.zeros(2), np.full(2, np.nan), np.full(2, 0.1 * balance.weight)):
        assert not recovery.is_needed(replace(pushed, foot_force=force))
    off = Recovery(balance, StandConfig(recovery_steps=False))
    assert not off.is_needed(pushed)


# ---- where to ----------------------------------------------------------------


def tick_of(balance, com=(0.0, 0.0), dcm=(0.0, 0.0)):
    """A tick with this CoM and DCM, both feet on the ground."""
    terms = SimpleNamespace(com=np.array(com), feet=FEET)
    observation = SimpleNamespace(terms=terms)
    pendulum = SimpleNamespace(omega=OMEGA)
    return SimpleNamespace(
        dcm=np.array(dcm),
        sole=(0.26, 0.12),
        observation=observation,
        pendulum=pendulum,
        balance=balance,
        config=CONFIG,
    )


def capture(balance, dcm, airborne=None):
    """The step that catches this DCM."""
    progress = WalkProgress(FEET, FEET, (), 3, None, CONFIG)
    return recovery_step(progress, tick_of(balance, dcm=dcm), airborne)


def at_touchdown(step, dcm):
    """The DCM at the times at which the foot may land, with the CoP at mid-sole."""
    adjustment, duration = CONFIG.adjustment, CONFIG.limits.duration.least
    times = np.linspace(adjustment.shortest_swing, CONFIG.timing.swing(duration), 50)
    cop = FEET[1 - step.foot].p_WF[:2]
    return cop + np.exp(OMEGA * times)[:, None] * (np.array(dcm) - cop)


@pytest.mark.parametrize(
    ("dcm", "foot"),
    [((0.18, 0.08), RIGHT), ((-0.16, -0.04), LEFT), ((0.0, 0.2), LEFT)],
)
def test_the_foot_steps_to_where_the_dcm_goes(balance, dcm, foot):
    step = capture(balance, dcm)
    duration = CONFIG.limits.duration.least
    assert (step.foot, step.index, step.duration) == (foot, 3, duration)
    assert step.p_WF[2] == 0.05
    # Short of the DCM by what ankles and double support can correct, never beyond it.
    axis = int(np.argmax(np.abs(dcm)))
    start = FEET[foot].p_WF[axis]
    way, gone = step.p_WF[axis] - start, at_touchdown(step, dcm)[:, axis] - start
    assert way * gone[-1] > 0.0
    assert abs(way) <= np.abs(gone).max()


def test_left_and_right_are_the_same(balance):
    for x, y in ((0.2, 0.1), (-0.15, 0.02), (0.02, 0.22), (-0.1, 0.3)):
        step, mirrored = capture(balance, (x, y)), capture(balance, (x, -y))
        assert step.foot == 1 - mirrored.foot
        np.testing.assert_allclose(step.p_WF, mirrored.p_WF * [1, -1, 1], atol=1e-12)


def test_a_step_ahead_or_back_hardly_spreads_the_feet(balance):
    for dcm in ((0.2, 0.0), (-0.15, 0.01)):
        step = capture(balance, dcm)
        ahead, across = np.abs(step.p_WF - FEET[1 - step.foot].p_WF)[:2]
        assert across - balance.stance.width < 0.3 * ahead


def test_a_foot_in_the_air_steps_whatever_it_costs(balance):
    for foot in (LEFT, RIGHT):
        assert capture(balance, (0.1, 0.2), airborne=foot).foot == foot


def swing_for_balance(balance, observation, known=1, turned=0.0):
    """A swing in a walk ahead, its pelvis turned from its reference, and its tick."""
    feet = observation.foot_poses
    steps = tuple(
        Footstep(3 + k, k, feet[k].p_WF, 0.0, 0.5, 0.1) for k in (LEFT, RIGHT)[:known]
    )
    progress = WalkProgress(feet, feet, steps, 3, None, CONFIG)
    pendulum = Pendulum(OMEGA, (-0.006, -0.005))
    body = replace(capture_body(observation.terms), yaw=-turned)
    tick = WalkTick(observation, body, False, balance, pendulum, CONFIG)
    return make_swing(progress, tick), tick


@pytest.mark.parametrize("known", [1, 2])
def test_the_same_error_moves_a_step_only_once(balance, observe, known):
    observation = observe(speed=0.3)
    moved, tick = swing_for_balance(balance, observation, known)
    shift = np.hypot(*(moved.step.p_WF - observation.foot_poses[LEFT].p_WF)[:2])
    assert shift > 0.06
    again = keep_balance(moved, tick)
    assert np.hypot(*(again.step.p_WF - moved.step.p_WF)[:2]) < 0.15 * shift


def test_a_step_for_balance_turns_with_the_pelvis_as_far_as_a_step_may(
    balance, observe
):
    limits = CONFIG.limits
    for turned, expected in (
        (0.0, 0.0),
        (0.2, 0.2),
        (-0.2, -0.2),
        (1.5, limits.toe_out),
        (-1.5, -limits.toe_in),
    ):
        swing, _ = swing_for_balance(balance, observe(speed=0.3), turned=turned)
        assert swing.step.yaw == pytest.approx(expected, abs=2e-3)
        # The foot is on the ground, and has the heading that it had.
        assert swing.motion.heading.angle == pytest.approx(0.0, abs=1e-3)


def test_a_step_that_need_not_move_keeps_its_heading(balance, observe):
    swing, _ = swing_for_balance(balance, observe())
    beyond = np.exp(-OMEGA * swing.duration) * swing.beyond_plan
    as_planned = observe(above=swing.planned.dcm + beyond)
    _, tick = swing_for_balance(balance, as_planned, turned=0.5)
    assert abs(tick.pelvis_turn) > 0.4
    assert keep_balance(swing, tick) is swing


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_square_up_step_puts_the_feet_side_by_side(balance, foot):
    landing = Footstep(4, 1 - foot, np.array([1.0, 0.0, 0.1]), np.pi / 2)
    step = square_up_step(landing, tick_of(balance))
    # The other foot points along y, and its left is along -x.
    side = outward(foot) * -balance.stance.width
    np.testing.assert_allclose(step.p_WF, [1.0 + side, 0.0, 0.1], atol=1e-12)
    assert step.yaw == pytest.approx(np.pi / 2)
    assert (step.foot, step.index) == (foot, 5)
