"""Soles touch as surfaces: no brick gets between the balls of a sole."""

import math

import numpy as np
import pytest

from atlas_drake.robot.file import SoleSize
from atlas_drake.robot.soles import CORNERS, RADIUS, RECESS, ball_centers

ATLAS = SoleSize(length=0.26, width=0.124887)


def depth(sole, x, y, turn, size=(0.10, 0.05)):
    """How far a brick's top gets into a sole before it touches [m]; inf if never."""
    c, s = math.cos(turn), math.sin(turn)
    depths = []
    radius = RADIUS * sole.width
    for center in ball_centers(sole):
        ahead, left, height = center - [x, y, 0.0]
        along, across = abs(c * ahead + s * left), abs(c * left - s * ahead)
        beside = math.hypot(
            max(along - size[0] / 2, 0.0), max(across - size[1] / 2, 0.0)
        )
        if beside < radius:
            depths.append(height - math.sqrt(radius**2 - beside**2))
    return min(depths, default=math.inf)


def test_a_brick_is_felt_anywhere_below_a_sole():
    rng = np.random.default_rng(3)
    for _ in range(2000):
        x = rng.uniform(-0.5, 0.5) * ATLAS.length
        y = rng.uniform(-0.5, 0.5) * ATLAS.width
        assert depth(ATLAS, x, y, rng.uniform(0.0, math.pi)) < 0.003


@pytest.mark.parametrize("length", [0.05, 0.17, 0.26])
def test_level_ground_is_touched_by_the_corners_alone(length):
    sole = SoleSize(length=length, width=0.4 * length)
    heights = np.array([center[2] for center in ball_centers(sole)])
    lowest = heights - RADIUS * sole.width
    np.testing.assert_allclose(lowest[:CORNERS], 0.0, atol=1e-12)
    np.testing.assert_allclose(lowest[CORNERS:], RECESS)
    corners = np.abs(ball_centers(sole)[:CORNERS])
    np.testing.assert_allclose(corners[:, 0], length / 2)
    np.testing.assert_allclose(corners[:, 1], 0.2 * length)
