"""The work of the motors, from made-up states."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.clients.campaigns.energy_meter import EnergyMeter

TICK = 0.01
"""[s]"""


def test_work_that_is_done_and_work_that_is_taken_are_counted_apart():
    meter = EnergyMeter([1, 3, 4], 6, TICK)
    simulator = Simulator(meter)
    context = simulator.get_mutable_context()
    meter.GetInputPort("effort").FixValue(context, [2.0, -3.0, 1.0])
    velocities = np.array([9.0, 1.0, 9.0, 1.0, -2.0, 9.0])
    meter.GetInputPort("state").FixValue(context, velocities)
    simulator.AdvanceTo(9.5 * TICK)
    work = meter.GetOutputPort("work").Eval(simulator.get_context())
    assert work == pytest.approx([2.0 * 10 * TICK, 5.0 * 10 * TICK])
