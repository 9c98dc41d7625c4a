"""The CoP and the pivot of the centroidal moment that balance asks for."""

import numpy as np
import pytest

from atlas_drake.support_polygon import SupportPolygon

HALF = 0.05
SQUARE = HALF * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.03, -0.08)])
@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0)])
def test_angular_momentum_helps_only_where_the_cop_does_not_suffice(
    balance, direction, offset
):
    # The legs' own momentum moves the CMP in any case, and takes no part in it.
    momentum, direction = balance.gains.momentum, np.array(direction)
    for beyond, shift in (
        (-0.02, 0.0),
        (0.9 * momentum.dead_zone, 0.0),
        (momentum.dead_zone + 0.02, 0.02),
        (1.0, momentum.largest_shift),
    ):
        desired = (HALF + beyond) * direction + offset
        cop, cmp = balance.pivots(desired, np.array(offset), SupportPolygon(SQUARE))
        np.testing.assert_allclose(cop, (HALF + min(beyond, 0.0)) * direction)
        np.testing.assert_allclose(cmp - cop - offset, shift * direction, atol=1e-12)
