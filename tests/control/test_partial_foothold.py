"""A sole that tips keeps the part of it that has ground below."""

import numpy as np
import pytest

from atlas_drake.control.feet.partial_foothold import TippingRules, carrying_part
from atlas_drake.rotations import rotation_about, rotation_z

RULES = TippingRules()
SOLE = np.array([[0.13, 0.06], [-0.13, 0.06], [-0.13, -0.06], [0.13, -0.06]])
REST = np.array([0.0, 0.0, 1.0])
R_WS = rotation_z(0.7)
"""Heading of the sole."""


def tipping(edge, direction, tilt=0.08, rate=1.0, corners=SOLE):
    """The part that carries while the sole sinks on the side of ``direction``.

    The edge lies ``edge`` [m] from the sole's middle on that side; axes of the sole.
    """
    direction = np.array([*direction, 0.0]) / np.hypot(*direction)
    axis = np.cross(REST, direction)
    R_WF = R_WS @ rotation_about(tilt * axis)
    w = R_WS @ (rate * axis)
    v = np.cross(w, -edge * R_WF @ direction)
    return carrying_part(corners, R_WF, np.concatenate([w, v]), REST, RULES)


@pytest.mark.parametrize("edge", [-0.03, 0.0, 0.04])
@pytest.mark.parametrize(
    ("direction", "axis", "sign"),
    [((1, 0), 0, 1), ((-1, 0), 0, -1), ((0, 1), 1, 1), ((0, -1), 1, -1)],
    ids=["toes", "heel", "left", "right"],
)
def test_the_side_that_sinks_does_not_carry(edge, direction, axis, sign):
    part = tipping(edge, direction)
    assert (sign * part[:, axis]).max() == pytest.approx(edge - RULES.margin)
    # The other edges stay.
    other = 1 - axis
    assert (sign * part[:, axis]).min() == (sign * SOLE[:, axis]).min()
    assert part[:, other].min() == SOLE[:, other].min()
    assert part[:, other].max() == SOLE[:, other].max()


def test_a_sole_that_tips_again_keeps_a_part_of_that_part():
    part = tipping(0.02, (0, -1), corners=tipping(0.03, (1, 0.5)))
    assert part[:, 1].min() == pytest.approx(RULES.margin - 0.02)
    aside = part @ np.array([1.0, 0.5]) / np.hypot(1.0, 0.5)
    assert aside.max() == pytest.approx(0.03 - RULES.margin)
    # Counterclockwise.
    x, y = part.T
    assert x @ np.roll(y, -1) > y @ np.roll(x, -1)


@pytest.mark.parametrize(
    "values",
    [
        {"tilt": 0.9 * RULES.tilt},
        {"rate": 0.9 * RULES.rate},
        {"tilt": -0.08},  # Back to how it rested.
        {"edge": 0.2},  # Beyond the sole.
        {"edge": -0.125},  # So little is left that the sole may as well tip.
    ],
    ids=str,
)
def test_a_sole_that_need_not_be_held_carries_as_before(values):
    assert tipping(**{"edge": 0.0, "direction": (1, 0), **values}) is None
