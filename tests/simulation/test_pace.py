"""The pace of a simulation that keeps to real time."""

import time

import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.primitives import ConstantVectorSource

from atlas_drake import AtlasSimulation
from atlas_drake.simulation.pace import SLACK, Pace


def seconds(act):
    begin = time.perf_counter()
    act()
    return time.perf_counter() - begin


@pytest.fixture
def paced():
    """Advances a simulation of nothing at real time."""
    simulator = Simulator(ConstantVectorSource([0.0]))
    pace = Pace(simulator)
    pace.set_rate(1.0)

    def advance(span, pieces=10):
        for _ in range(pieces):
            pace.forget_lost_time()
            simulator.AdvanceTo(simulator.get_context().get_time() + span / pieces)

    return advance


@pytest.mark.slow
def test_lost_time_is_not_made_up_for(paced):
    for _ in range(2):  # At the start, and between two commands.
        time.sleep(0.3)
        assert seconds(lambda: paced(0.3)) > 0.3 - 0.5 * SLACK


@pytest.mark.slow
def test_a_simulation_waits_at_its_start_and_between_advances():
    sim = AtlasSimulation()
    sim.set_realtime_rate(0.1)
    for _ in range(2):
        time.sleep(0.4)
        assert seconds(lambda: sim.advance(0.04)) > 0.4 - SLACK
