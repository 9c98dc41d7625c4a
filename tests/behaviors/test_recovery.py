"""Steps that nobody commanded: when they are needed, and where they go."""

from types import SimpleNamespace

import numpy as np
import pytest

from atlas_drake.behaviors.recovery import Recovery
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.recovery_steps import (
    needs_square_up,
    recovery_step,
    square_up_step,
)
from atlas_drake.behaviors.walk.steps import WalkProgress
from atlas_drake.control.feet.footstep import outward
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose

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
        observation=observation,
        pendulum=pendulum,
        balance=balance,
        config=CONFIG,
    )


def capture(balance, com, dcm, **goes_on):
    """The step, the CoP on the other sole, and the distance of the DCM from it."""
    progress = WalkProgress(FEET, FEET, (), 3, None, CONFIG)
    step = recovery_step(progress, tick_of(balance, com, dcm), **goes_on)
    dcm = np.array(dcm)
    cop = balance.support(FEET[1 - step.foot]).clamp(dcm)
    return step, cop, dcm - cop


FAST = np.exp(OMEGA * CONFIG.adjustment.shortest_swing)
USUAL = np.exp(OMEGA * CONFIG.timing.swing(CONFIG.limits.duration.least))


@pytest.mark.parametrize(
    ("dcm", "foot"), [((0.15, 0.19), RIGHT), ((-0.12, -0.19), LEFT)]
)
def test_the_unloaded_foot_steps_to_where_the_dcm_goes(balance, dcm, foot):
    step, cop, ahead = capture(balance, (0.0, 0.0), dcm)
    shortest = CONFIG.limits.duration.least
    assert (step.foot, step.index, step.duration) == (foot, 3, shortest)
    assert step.p_WF[2] == 0.05
    # Ahead it gets there or to its limit.
    point = cop + USUAL * ahead
    assert step.p_WF[0] == pytest.approx(np.clip(point[0], -0.32, 0.42))


def test_a_step_back_does_not_spread_the_feet_but_one_aside_does(balance):
    back, cop, ahead = capture(balance, (0.0, 0.02), (-0.13, 0.02))
    assert back.foot == LEFT
    assert back.p_WF[1] == pytest.approx(cop[1] + FAST * ahead[1])
    aside, cop, ahead = capture(balance, (-0.08, -0.03), (-0.13, 0.02))
    assert aside.p_WF[1] == pytest.approx(min(cop[1] + USUAL * ahead[1], 0.38))


def test_in_a_walk_that_goes_on_the_step_is_no_longer_than_needed(balance):
    step, cop, ahead = capture(balance, (0.0, 0.0), (0.13, 0.19), goes_on=True)
    np.testing.assert_allclose(step.p_WF[:1], (cop + FAST * ahead)[:1])


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_a_square_up_step_puts_the_feet_side_by_side(balance, foot):
    feet, turned = list(FEET), np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    feet[1 - foot] = FootPose(np.array([1.0, 0.0, 0.1]), turned)
    progress = WalkProgress(tuple(feet), FEET, (), 5, None, CONFIG)
    step = square_up_step(progress, 1 - foot, tick_of(balance))
    # The other foot points along y, and its left is along -x.
    side = outward(foot) * -balance.stance.width
    np.testing.assert_allclose(step.p_WF, [1.0 + side, 0.0, 0.1], atol=1e-12)
    assert step.yaw == pytest.approx(np.pi / 2)
    assert (step.foot, step.index) == (foot, 5)


@pytest.mark.parametrize("last", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("apart", "recovered", "needed"),
    [(0.2, True, True), (0.02, True, False), (0.2, False, False)],
)
def test_feet_that_stand_apart_after_a_recovery_step_need_one_more(
    balance, last, apart, recovered, needed
):
    feet = list(FEET)
    beside = [-apart, outward(1 - last) * balance.stance.width, 0.0]
    feet[1 - last] = FootPose(feet[last].p_WF + beside, np.eye(3))
    progress = WalkProgress(
        tuple(feet),
        FEET,
        (),
        2,
        None,
        CONFIG,
        last_foot=last,
        last_index=1,
        recovery_index=1 if recovered else 0,
    )
    assert needs_square_up(progress, tick_of(balance)) is needed
