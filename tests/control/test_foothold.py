"""What is known of a sole that does not land flat where its step leads."""

import numpy as np
import pytest

from atlas_drake.control.balance.foothold import (
    Foothold,
    corner_heights,
    corners_down,
    ground_below,
    observed,
)
from atlas_drake.control.gains import ContactModel
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import rotation_about
from atlas_drake.support_polygon import SupportPolygon

MODEL = ContactModel()
CORNERS = np.array([[0.11, 0.05], [-0.11, 0.05], [-0.11, -0.05], [0.11, -0.05]])
GROUND = FootPose(np.array([0.3, 0.1, 0.0]), np.eye(3))
TOES_UP = rotation_about(np.array([0.0, -0.1, 0.0]))


def sole(R_WF, z):
    return FootPose(np.array([0.3, 0.1, z]), R_WF)


def seen(foothold, R_WF, z, *cops):
    for cop in cops:
        down = corners_down(GROUND, sole(R_WF, z), CORNERS)
        foothold = observed(foothold, down, R_WF[:, 2], np.array(cop), CORNERS, MODEL)
    return foothold


def outside(foothold, point):
    return SupportPolygon(foothold.part).distance_outside(np.array(point))


def test_corners_are_down_within_the_tolerance_on_a_slope_too():
    for tilt in (np.eye(3), rotation_about(np.array([0.1, 0.2, 0.0]))):
        ground = FootPose(GROUND.p_WF, tilt)
        for height, is_down in ((0.0, True), (0.01, False), (-0.01, False)):
            p_WF = ground.p_WF + height * tilt[:, 2] + 0.02 * tilt[:, 0]
            there = FootPose(p_WF, tilt)
            heights = corner_heights(ground, there, CORNERS)
            np.testing.assert_allclose(heights, height, atol=1e-12)
            assert (corners_down(ground, there, CORNERS) == is_down).all()
            below = ground_below(there, ground)
            np.testing.assert_allclose(
                below.p_WF, p_WF - height * tilt[:, 2], atol=1e-12
            )


def test_a_sole_on_a_brick_carries_at_its_heel_and_where_the_cop_has_been():
    # The heel is down, the toes are up: a brick is below the front of the sole.
    foothold = seen(Foothold(GROUND), TOES_UP, 0.011, [0.04, 0.0], [-0.05, 0.01])
    for inside in ([-0.11, 0.05], [-0.11, -0.05], [0.04, 0.0], [-0.05, 0.01]):
        assert outside(foothold, inside) < 1e-9
    assert outside(foothold, [0.04 + MODEL.explored + 1e-3, 0.0]) > 0.0
    for corner in ([0.11, 0.05], [0.11, -0.05]):
        assert outside(foothold, corner) > 0.03


def test_a_sole_that_turns_stands_on_other_places():
    first = seen(Foothold(GROUND), TOES_UP, 0.011, [0.04, 0.0])
    further = rotation_about(np.array([0.1, 0.0, 0.0]))
    after = seen(first, further, 0.03, [0.0, -0.03])
    assert outside(after, [0.04, 0.0]) > 0.01
    assert outside(after, [0.0, -0.03]) < 0.0


@pytest.mark.parametrize("seed", range(3))
def test_a_part_has_few_corners_and_never_leaves_the_sole(seed):
    rng = np.random.default_rng(seed)
    foothold = seen(
        Foothold(GROUND), TOES_UP, 0.05, *rng.uniform(-0.3, 0.3, size=(40, 2))
    )
    assert len(foothold.part) <= 6
    assert (np.abs(foothold.part) <= CORNERS.max(axis=0) + 1e-12).all()
    SupportPolygon(foothold.part)
