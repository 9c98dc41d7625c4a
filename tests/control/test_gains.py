"""Tuned values against what their descriptions promise, on robots of the tutorial."""

import pytest

from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.control.balance.step_adjustment import StepAdjustmentLimits
from atlas_drake.control.gains import ContactModel, ControlGains
from atlas_drake.scenario import Scenario

from .conftest import TUTORIAL_ROBOTS

GAINS = ControlGains()


@pytest.mark.parametrize(
    "name",
    [
        "joint_limits",
        "com_height",
        "orientation",
        "swing_position",
        "swing_orientation",
        "posture",
    ],
)
def test_every_spring_is_damped_critically(name):
    gains = getattr(GAINS, name)
    assert gains.kd == pytest.approx(2.0 * gains.kp**0.5, rel=0.06)


def test_a_sole_is_trusted_with_the_full_weight_after_four_ticks():
    model, felt, ticks = ContactModel(), 0.0, -1
    while felt < 1.0 and ticks < 9:
        felt = model.unloaded_share + model.load_growth * felt
        ticks += 1
    assert ticks == 4


@pytest.mark.parametrize("robot", TUTORIAL_ROBOTS, indirect=True)
def test_the_ankles_hold_a_cop_within_the_sole(robot):
    sole, contact, limits = robot.file.sole, GAINS.contact, StepAdjustmentLimits()
    ahead = 0.5 * sole.length - contact.length_margin
    assert 0.7 * ahead < limits.cop_forward < ahead
    aside = 0.5 * sole.width - contact.width_margin - WalkConfig().cop_inward
    assert 0.7 * aside < limits.cop_sideways < aside


def test_assumptions_on_the_ground_have_a_reserve():
    assert 0.5 < GAINS.contact.friction / Scenario().ground_friction < 0.7
    assert GAINS.weights.com_height < GAINS.weights.moment
