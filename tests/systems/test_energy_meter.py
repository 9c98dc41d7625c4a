"""The work of the motors, from efforts and velocities that do not change."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.systems.run_statistics import EnergyMeter

PERIOD = 0.01


def test_work_that_is_done_and_work_that_is_taken_are_counted_apart():
    meter = EnergyMeter([1, 3, 4], 6, PERIOD)
    simulator = Simulator(meter)
    context = simulator.get_mutable_context()
    meter.GetInputPort("effort").FixValue(context, [2.0, -3.0, 1.0])
    velocities = np.array([9.0, 1.0, 9.0, 1.0, -2.0, 9.0])
    meter.GetInputPort("state").FixValue(context, velocities)
    simulator.AdvanceTo(9.5 * PERIOD)
    work = meter.GetOutputPort("work").Eval(simulator.get_context())
    assert work == pytest.approx([2.0 * 10 * PERIOD, 5.0 * 10 * PERIOD])
