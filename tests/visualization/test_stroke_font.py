"""The stroke font, and the ribbons that give its strokes a width."""

import string

import numpy as np
import pytest

from atlas_drake.visualization.shapes import ribbons
from atlas_drake.visualization.stroke_font import text_segments

HEIGHT = 0.06


def test_text_is_centered_and_as_high_as_asked():
    starts, ends = text_segments("HOH", HEIGHT)
    points = np.hstack([starts, ends])
    assert points[0].min() == pytest.approx(-points[0].max())
    assert points[1].min() == pytest.approx(0.0)
    assert points[1].max() == pytest.approx(HEIGHT)
    assert np.all(points[2] == 0.0)
    # Lower case is written in capitals.
    np.testing.assert_array_equal(np.hstack(text_segments("hoh", HEIGHT)), points)
    for text in ("", "  "):
        assert np.hstack(text_segments(text, HEIGHT)).shape == (3, 0)


def test_every_letter_stays_in_its_cell_and_has_its_own_shape():
    box = np.hstack(text_segments("\u20ac", HEIGHT))  # What the font lacks.
    assert box.shape == (3, 8)
    letters = string.ascii_uppercase + string.digits + "-.,:()/>!"
    shapes = {tuple(box.ravel().round(6))}
    for letter in letters:
        points = np.hstack(text_segments(letter, HEIGHT))
        assert np.abs(points[0]).max() <= HEIGHT * 2 / 6 + 1e-12, letter
        assert points[1].min() >= -1e-12, letter
        assert points[1].max() <= HEIGHT + 1e-12, letter
        shapes.add(tuple(points.ravel().round(6)))
    assert len(shapes) == 1 + len(letters)


def area(vertices, faces):
    a, b, c = (vertices[:2, faces[i]] for i in range(3))
    u, v = b - a, c - a
    return 0.5 * (u[0] * v[1] - u[1] * v[0])


def test_a_ribbon_covers_its_line_and_half_its_width_beyond():
    starts = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    ends = np.array([[3.0, 1.0], [4.0, 3.0], [0.0, 0.0]])
    vertices, faces = ribbons(starts, ends, 0.2)
    assert vertices.shape == (3, 8)
    assert faces.dtype == np.int32
    areas = area(vertices, faces)
    # All faces look to the same side: up.
    assert np.all(areas > 0.0)
    assert areas.sum() == pytest.approx((5.0 + 0.2) * 0.2 + (2.0 + 0.2) * 0.2)
    across = vertices[:2, 0] - vertices[:2, 1]
    assert np.linalg.norm(across) == pytest.approx(0.2)
    assert across @ np.array([3.0, 4.0]) == pytest.approx(0.0)
    dot, _ = ribbons(starts[:, :1], starts[:, :1], 0.2)
    assert np.isfinite(dot).all()
