"""Support polygons: hull, distance, nearest point inside, and load shares of two."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atlas_drake.robot.soles import sole_corners
from atlas_drake.rotations import rotation_y, rotation_z
from atlas_drake.support_polygon import SupportPolygon, load_share_range

COORDINATES = st.floats(-1.0, 1.0)


def cloud(seed, size=30):
    return np.random.default_rng(seed).normal(size=(size, 2))


@pytest.mark.parametrize("seed", range(3))
def test_hull_is_convex_counter_clockwise_and_of_the_points(seed):
    points = cloud(seed)
    polygon = SupportPolygon(points)
    edges = np.roll(polygon.vertices, -1, axis=0) - polygon.vertices
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    assert (turns > 0.0).all()
    assert {tuple(v) for v in polygon.vertices} <= {tuple(p) for p in points}
    assert max(polygon.distance_outside(p) for p in points) <= 1e-12


@given(x=COORDINATES, y=COORDINATES, seed=st.integers(0, 5))
def test_clamp_gives_the_nearest_point(x, y, seed):
    polygon = SupportPolygon(0.4 * cloud(seed))
    point = np.array([x, y])
    nearest = polygon.clamp(point)
    if polygon.distance_outside(point) <= 0.0:
        np.testing.assert_array_equal(nearest, point)
        return
    assert polygon.distance_outside(nearest) <= 1e-12
    gap = point - nearest
    # Nearest of a convex set: no corner lies further out along the gap.
    assert ((polygon.vertices - nearest) @ gap).max() <= 1e-9
    np.testing.assert_allclose(polygon.clamp(nearest), nearest, atol=1e-12)


@given(x=st.floats(-2.0, 3.0), y=st.floats(-2.0, 3.0))
def test_unit_square(x, y):
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    polygon = SupportPolygon([np.array(corner) for corner in corners])
    point = np.array([x, y])
    np.testing.assert_allclose(polygon.clamp(point), np.clip(point, 0, 1), atol=1e-12)
    outside = np.maximum(-point, point - 1.0).max()
    assert polygon.distance_outside(point) == pytest.approx(outside, abs=1e-12)


def test_sole_corners_lie_in_the_sole_plane_about_its_center():
    p_WF, R_WF = np.array([1.0, -2.0, 0.5]), rotation_z(0.7) @ rotation_y(0.2)
    corners = sole_corners(p_WF, R_WF, half_length=0.13, half_width=0.06)
    np.testing.assert_allclose(corners.mean(axis=0), p_WF)
    in_sole = (corners - p_WF) @ R_WF
    np.testing.assert_allclose(in_sole[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(np.abs(in_sole[:, :2]), [[0.13, 0.06]] * 4)
    assert len({tuple(np.sign(row)) for row in in_sole[:, :2]}) == 4


LEFT, RIGHT = (
    SupportPolygon(sole_corners(np.array([x, y, 0.0]), np.eye(3), 0.12, 0.05))
    for x, y in ((0.0, 0.2), (0.1, -0.2))
)


@given(x=st.floats(-0.2, 0.3), y=st.floats(-0.3, 0.3))
def test_every_load_share_in_the_range_will_do_and_no_other(x, y):
    """Against Minkowski sums by brute force."""
    cop = np.array([x, y])
    low, high = load_share_range(cop, LEFT, RIGHT)
    assert low <= high
    for share in np.linspace(0.01, 0.99, 15):
        points = (1.0 - share) * LEFT.vertices[:, None] + share * RIGHT.vertices[None]
        outside = SupportPolygon(points.reshape(-1, 2)).distance_outside(cop)
        if low + 1e-6 <= share <= high - 1e-6:
            assert outside <= 1e-9
        elif not low - 1e-6 <= share <= high + 1e-6:
            assert outside > 0.0


@pytest.mark.parametrize(("cop", "share"), [((0.0, 0.4), 0.0), ((0.0, -0.4), 1.0)])
def test_a_point_outside_has_one_share_that_is_nearest(cop, share):
    assert load_share_range(np.array(cop), LEFT, RIGHT) == (share, share)
    low, high = load_share_range(np.array([0.5, 0.0]), LEFT, RIGHT)
    assert low == high
