"""Support polygons: hull, distance and the nearest point inside."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.sole import sole_corners
from atlas_drake.rotations import rotation_y, rotation_z

COORDINATES = st.floats(-1.0, 1.0)


def cloud(seed, size=30):
    return np.random.default_rng(seed).normal(size=(size, 2))


def crosses(polygon):
    """Twice the area between each pair of successive edges."""
    edges = np.roll(polygon.vertices, -1, axis=0) - polygon.vertices
    following = np.roll(edges, -1, axis=0)
    return edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]


@pytest.mark.parametrize("seed", range(3))
def test_hull_is_convex_counter_clockwise_and_of_the_points(seed):
    points = cloud(seed)
    polygon = SupportPolygon(points)
    assert (crosses(polygon) > 0.0).all()
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


@pytest.mark.parametrize(
    ("point", "nearest", "outside"),
    [
        ((0.5, 0.5), (0.5, 0.5), -0.5),
        ((0.9, 0.5), (0.9, 0.5), -0.1),
        ((1.5, 0.5), (1.0, 0.5), 0.5),
        ((2.0, 3.0), (1.0, 1.0), 2.0),
        ((-1.0, -1.0), (0.0, 0.0), 1.0),
    ],
)
def test_unit_square(point, nearest, outside):
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    polygon = SupportPolygon([np.array(corner) for corner in corners])
    np.testing.assert_allclose(polygon.clamp(np.array(point)), nearest, atol=1e-15)
    assert polygon.distance_outside(np.array(point)) == pytest.approx(outside)


def test_sole_corners_lie_in_the_sole_plane_about_its_center():
    p_WF, R_WF = np.array([1.0, -2.0, 0.5]), rotation_z(0.7) @ rotation_y(0.2)
    corners = sole_corners(p_WF, R_WF, half_length=0.13, half_width=0.06)
    np.testing.assert_allclose(corners.mean(axis=0), p_WF)
    in_sole = (corners - p_WF) @ R_WF
    np.testing.assert_allclose(in_sole[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(np.abs(in_sole[:, 0]), 0.13)
    np.testing.assert_allclose(np.abs(in_sole[:, 1]), 0.06)
    assert len({tuple(np.sign(row)) for row in in_sole[:, :2]}) == 4
