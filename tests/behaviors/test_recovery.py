"""Steps that nobody commanded: when they are needed, where they go, what follows."""

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.balance import StanceConfig
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.recovery import Recovery, walk_without_steps
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.gait import capture_step, square_up_step
from atlas_drake.behaviors.walk.phases import FinalTransfer, InitialTransfer, WalkSwing
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.feet.footstep import outward
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep

from .conftest import as_request

PUSHED = 0.8
"""Speed of the robot after a push from which only a step saves it [m/s]."""
CONFIG = WalkConfig()
OMEGA = 3.3


@pytest.fixture(scope="module")
def walk(make_tools, observe):
    terms = observe().terms
    return Walk(make_tools(float(terms.com[2] - terms.feet[0].p_WF[2])), CONFIG)


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


def capture(balance, com, dcm, **goes_on):
    """The step, the CoP on the other sole, and the distance of the DCM from it."""
    feet = tuple(FootPose(np.array([0.0, y, 0.05]), np.eye(3)) for y in (0.12, -0.12))
    supports = tuple(balance.support(pose) for pose in feet)
    com, dcm = np.array(com), np.array(dcm)
    step = capture_step(
        3, (LEFT, RIGHT), feet, supports, com, dcm, OMEGA, CONFIG, **goes_on
    )
    cop = supports[1 - step.foot].clamp(dcm)
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
def test_a_square_up_step_puts_the_feet_side_by_side(foot):
    other = FootPose(
        np.array([1.0, 0.0, 0.1]), np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    )
    step = square_up_step(5, foot, other, 0.3, CONFIG)
    # The other foot points along y, and its left is along -x.
    side = -0.3 if foot == LEFT else 0.3
    np.testing.assert_allclose(step.p_WF, [1.0 + side, 0.0, 0.1], atol=1e-12)
    assert step.yaw == pytest.approx(np.pi / 2)


# ---- in the walk -------------------------------------------------------------


def entered(walk, seen, message=None):
    request = as_request(message or AtlasSimInterfaceCommand(behavior="WALK"))
    if message is None:
        request = walk_without_steps(request)
    body = capture_body(seen.terms)
    return walk.enter(seen, body, request), body, request


def test_a_walk_without_steps_catches_a_lost_balance_at_once(walk, observe):
    seen = observe(speed=PUSHED)
    phase, body, request = entered(walk, seen)
    outcome = walk.update(phase, seen, body, request, leaving=False)
    assert isinstance(outcome.state, WalkSwing)
    assert outcome.state.progress.last_was_recovery
    assert outcome.state.step.p_WF[0] > 0.2
    (event,) = outcome.events
    assert event.kind == "recovery"
    assert event.text.endswith("catches the balance")
    # A robot at rest settles instead.
    rest = observe()
    phase, body, request = entered(walk, rest)
    phase = replace(phase, elapsed=phase.duration)
    outcome = walk.update(phase, rest, body, request, leaving=False)
    assert isinstance(outcome.state, FinalTransfer)


def test_lift_off_is_brought_forward_while_the_balance_is_lost(
    walk, observe, walk_message
):
    pushed = observe(speed=PUSHED)
    message = walk_message((1, 0, 0.2, 0.14), (2, 1, 0.2, -0.14))
    phase, body, request = entered(walk, observe(), message)
    outcome = walk.update(phase, pushed, body, request, leaving=False)
    brought_forward = outcome.state
    assert isinstance(brought_forward, InitialTransfer)
    assert brought_forward.brought_forward
    assert brought_forward.duration - brought_forward.elapsed == pytest.approx(
        CONFIG.rules.hurried_transfer
    )
    late = replace(brought_forward, elapsed=brought_forward.duration)
    outcome = walk.update(late, pushed, body, request, leaving=False)
    assert isinstance(outcome.state, WalkSwing)
    # Without a push the same phase goes on.
    outcome = walk.update(phase, observe(), body, request, leaving=False)
    assert not outcome.state.brought_forward
    assert outcome.state.duration == phase.duration


@pytest.mark.parametrize(
    ("foot", "aside", "ahead"),
    [(LEFT, 0.12, 0.0), (RIGHT, 0.12, 0.0), (LEFT, 0.0, 0.16), (LEFT, 0.0, -0.16)],
    ids=["over it", "over the other", "ahead", "behind"],
)
def test_a_foot_that_landed_steps_again_if_the_dcm_is_beyond_its_outer_side(
    walk, observe, walk_message, foot, aside, ahead
):
    message = walk_message((1, LEFT, 0.0, 0.14), (2, RIGHT, 0.2, -0.14))
    seen = observe()
    phase, body, request = entered(walk, seen, message)
    feet = phase.progress.feet
    progress = replace(
        phase.progress,
        pending=phase.progress.pending[1:],
        next_index=2,
        last_foot=LEFT,
        last_index=1,
    )
    transfer = walk.planner.land(progress, feet[LEFT].p_WF[:2], 0.0)
    lost = feet[foot].p_WF[:2] + np.array([ahead, outward(foot) * aside])
    outcome = walk.update(transfer, observe(above=lost), body, request, leaving=False)
    if foot == RIGHT or ahead:  # The foot that lifts off next is the right one.
        assert outcome.state.brought_forward
        return
    swing = outcome.state
    assert isinstance(swing, WalkSwing)
    assert (swing.step.foot, swing.step.index) == (LEFT, 1)
    assert swing.step.p_WF[1] > feet[LEFT].p_WF[1] + 0.05
    assert swing.progress.last_was_recovery
    # The steps to come are still there.
    assert [step.index for step in walk.planner.coming(swing.progress)] == [2]


def settled(walk, observe, foot, apart):
    """A walk at rest after a recovery step of ``foot``, the other ``apart`` behind."""
    seen = observe()
    phase, body, request = entered(walk, seen)
    phase = replace(phase, elapsed=phase.duration)
    settle = walk.update(phase, seen, body, request, leaving=False).state
    feet = list(settle.progress.feet)
    beside = outward(1 - foot) * StanceConfig().width
    place = feet[foot].p_WF + np.array([-apart, beside, 0.0])
    feet[1 - foot] = FootPose(place, feet[foot].R_WF)
    progress = replace(
        settle.progress,
        feet=tuple(feet),
        recovery_index=1,
        last_index=1,
        last_foot=foot,
        next_index=2,
    )
    settle = replace(settle, progress=progress, elapsed=settle.duration + 1.0)
    return walk.update(settle, seen, body, request, leaving=False)


@pytest.mark.parametrize("foot", [LEFT, RIGHT])
def test_feet_apart_after_a_recovery_step_are_squared_up(walk, observe, foot):
    outcome = settled(walk, observe, foot, 0.2)
    assert isinstance(outcome.state, InitialTransfer)
    (step,) = outcome.state.progress.pending
    assert isinstance(step, Footstep)
    assert (step.foot, step.index) == (1 - foot, 2)
    assert not outcome.finished
    # Feet that still stand apart after that step are put side by side again.
    assert outcome.state.progress.recovery_index == 2
    assert settled(walk, observe, foot, 0.02).finished
