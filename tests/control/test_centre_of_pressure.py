"""The center of pressure from the wrenches on both soles."""

import numpy as np

from atlas_drake.control.wrenches import center_of_pressure


def test_the_cop_is_the_loads_mean_shifted_by_the_moments():
    soles = np.array([[0.0, 0.1, 0.0], [0.3, -0.1, 0.2]])
    wrenches = np.zeros(12)
    assert center_of_pressure(soles, wrenches) is None
    wrenches[5] = wrenches[11] = 400.0
    np.testing.assert_allclose(center_of_pressure(soles, wrenches), [0.15, 0.0, 0.1])
    # The left foot alone, pressed 5 cm before and 2 cm left of its center.
    wrenches[11] = 0.0
    wrenches[:3] = np.cross([0.05, 0.02, 0.0], [0.0, 0.0, 400.0])
    np.testing.assert_allclose(center_of_pressure(soles, wrenches), [0.05, 0.12, 0.0])


def test_a_foot_that_barely_touches_has_no_cop():
    wrenches = np.zeros(12)
    for load, exists in ((19.0, False), (21.0, True)):
        wrenches[5] = load
        assert (center_of_pressure(np.zeros((2, 3)), wrenches) is not None) == exists
