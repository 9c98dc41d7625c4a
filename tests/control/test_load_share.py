"""The load shares of two feet, against Minkowski sums by brute force."""

import numpy as np
import pytest

from atlas_drake.control.balance.support_polygon import SupportPolygon, load_share_range
from atlas_drake.control.feet.sole import sole_corners

UPRIGHT = np.eye(3)


def sole(x, y, half_length=0.12, half_width=0.05):
    return SupportPolygon(
        sole_corners(np.array([x, y, 0.0]), UPRIGHT, half_length, half_width)
    )


LEFT, RIGHT = sole(0.0, 0.2), sole(0.1, -0.2)


def reaches(cop, share):
    """Whether the CoP can be there with this share on the right foot."""
    points = (1.0 - share) * LEFT.vertices[:, None] + share * RIGHT.vertices[None]
    return SupportPolygon(points.reshape(-1, 2)).distance_outside(cop) <= 1e-9


@pytest.mark.parametrize(
    "cop", [(0.0, 0.2), (0.05, 0.0), (0.1, 0.12), (0.0, 0.249), (0.2, -0.22)]
)
def test_every_share_in_the_range_will_do_and_no_other(cop):
    low, high = load_share_range(np.array(cop), LEFT, RIGHT)
    assert low <= high
    for share in np.linspace(0.01, 0.99, 99):
        inside = low - 1e-9 <= share <= high + 1e-9
        assert reaches(np.array(cop), share) == inside


def test_a_point_outside_has_one_share_that_is_nearest():
    low, high = load_share_range(np.array([0.0, 0.4]), LEFT, RIGHT)
    assert low == high == 0.0
    low, high = load_share_range(np.array([0.0, -0.4]), LEFT, RIGHT)
    assert low == high == 1.0
    low, high = load_share_range(np.array([0.5, 0.0]), LEFT, RIGHT)
    assert low == high
