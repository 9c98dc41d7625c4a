"""The demo's movement: smooth, periodic, and within the allowed amplitude."""

import numpy as np
import pytest

from atlas_drake.parts.manipulate.pelvis_demo import (
    COORDINATES,
    PERIOD,
    DemoMovements,
    demo_amplitude,
    demo_pose,
)
from atlas_drake.parts.manipulate.pelvis_pose import PelvisPose

HOME = PelvisPose(0.89)
MOVEMENTS = DemoMovements()
ROUND = PERIOD * len(COORDINATES)
TIMES = np.arange(0.0, ROUND, 0.01)


def path(share):
    return np.array([demo_pose(HOME, MOVEMENTS, share, float(time)) for time in TIMES])


def test_the_demo_starts_at_rest_at_home_and_is_periodic():
    assert demo_pose(HOME, MOVEMENTS, 1.0, 0.0) == HOME
    np.testing.assert_allclose(demo_pose(HOME, MOVEMENTS, 1.0, 1e-3), HOME, atol=1e-6)
    for time in (0.7, 8.1, 20.0):
        np.testing.assert_allclose(
            demo_pose(HOME, MOVEMENTS, 1.0, time),
            demo_pose(HOME, MOVEMENTS, 1.0, time + ROUND),
            atol=1e-9,
        )


def test_each_coordinate_reaches_its_amplitude_smoothly():
    poses = path(1.0)
    for name in COORDINATES:
        size = getattr(MOVEMENTS, name)
        moved = poses[:, PelvisPose._fields.index(name)] - getattr(HOME, name)
        assert np.abs(moved).max() == pytest.approx(abs(size), rel=0.01)
        # To one side, or to both.
        assert (moved.min() * moved.max() < -1e-6) == (name != "height")
    assert np.abs(np.diff(poses, axis=0)).max() < 0.35 * 0.01
    # Nor does the speed jump.
    assert np.abs(np.diff(poses, 2, axis=0)).max() < 2.0 * 0.01**2


def test_the_amplitude_shrinks_to_what_is_allowed():
    half = demo_amplitude(HOME, MOVEMENTS, lambda pose: abs(pose.yaw) < 0.07)
    assert half == 0.5
    assert np.abs(path(half)[:, 1]).max() < 0.07
    assert demo_amplitude(HOME, MOVEMENTS, lambda pose: True) == 1.0
    assert demo_amplitude(HOME, MOVEMENTS, lambda pose: pose == HOME) == 0.0
