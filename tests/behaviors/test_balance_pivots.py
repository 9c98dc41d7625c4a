"""The CoP and the pivot of the centroidal moment that balance asks for."""

import numpy as np
import pytest

from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon

OMEGA = 3.3
HALF = 0.05
SQUARE = HALF * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0)])
def test_angular_momentum_helps_only_where_the_cop_does_not_suffice(
    balance, observe, direction
):
    gains, direction = balance.gains.momentum, np.array(direction)
    for beyond, shift in (
        (-0.02, 0.0),
        (0.9 * gains.dead_zone, 0.0),
        (gains.dead_zone + 0.02, 0.02),
        (1.0, gains.largest_shift),
    ):
        error = (HALF + beyond) / (1.0 + balance.gains.dcm_gain)
        seen, rest = observe(above=error * direction), np.zeros(2)
        reference = DcmReference(dcm=rest, cop=rest)
        cop, cmp = balance.desired_pivots(
            seen, reference, OMEGA, SupportPolygon(SQUARE)
        )
        np.testing.assert_allclose(cop, (HALF + min(beyond, 0.0)) * direction)
        np.testing.assert_allclose(cmp - cop, shift * direction, atol=1e-12)
