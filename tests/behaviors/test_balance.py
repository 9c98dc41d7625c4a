"""The commands that ``Balance`` makes of references, and the region of the CoP."""

import numpy as np
import pytest

from atlas_drake.behaviors.balance import Balance
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.feet.swing_foot import SwingReference
from atlas_drake.control.gains import ControlGains
from atlas_drake.frozen import replace

FOOT = FootPose(np.array([1.0, 0.5, 0.0]), np.eye(3))


@pytest.fixture(scope="module")
def balance(robot):
    return Balance(robot, ControlGains())


@pytest.mark.parametrize("side", [0, 1])
def test_the_cop_stays_inside_the_sole_by_a_margin(balance, side):
    sole, contact = balance.robot.file.sole, balance.gains.contact
    margin = (contact.length_margin, contact.width_margin)[side]
    edge = 0.5 * (sole.length, sole.width)[side] - margin
    for sign in (-1.0, 1.0):
        far = FOOT.p_WF[:2].copy()
        far[side] += sign * 10.0
        expected = FOOT.p_WF[:2].copy()
        expected[side] += sign * edge
        clamped = balance.support(FOOT).clamp(far)
        np.testing.assert_allclose(clamped[side], expected[side], atol=1e-12)


def test_a_swinging_foot_is_pulled_to_its_reference(balance, observe):
    seen, gains = observe(), balance.gains.swing_position
    foot = seen.terms.feet[1]
    ahead, faster, sooner = np.array([[0.03, -0.02, 0.01], [0.1, 0.2, -0.3], [1, 2, 3]])
    reference = SwingReference(
        p_WF=foot.p_WF + ahead,
        v_WF=foot.V_WF[3:] + faster,
        a_WF=sooner,
        R_WF=foot.R_WF,
        w_WF=foot.V_WF[:3],
        alpha_WF=sooner,
    )
    command = balance.swinging(seen, 1, reference)
    expected = sooner + gains.kp * ahead + gains.kd * faster
    np.testing.assert_allclose(command.task.target[3:], expected)
    np.testing.assert_allclose(command.task.target[:3], sooner, atol=1e-9)
    assert command.contact is None


@pytest.mark.parametrize(
    ("felt", "limit"),
    [(-0.1, 0.1), (0.0, 0.1), (0.05, 0.175), (0.2, 0.4), (3.0, 3.0), (np.nan, 3.0)],
)
def test_a_planted_sole_is_trusted_with_little_more_than_it_carries(
    balance, observe, felt, limit
):
    seen = replace(observe(), foot_force=np.full(2, felt * balance.weight))
    contact = balance.planted(seen, 1).contact
    assert contact.max_normal_force == pytest.approx(limit * balance.weight)
    # Where it carries next to nothing, a moment would only turn the foot.
    reach = np.abs(contact.patch.corners).max()
    assert (reach < 0.02) == (felt < 0.1)
    # What the behavior itself allows is never exceeded.
    less = balance.planted(seen, 1, max_load=0.05).contact
    assert less.max_normal_force == pytest.approx(0.05 * balance.weight)
