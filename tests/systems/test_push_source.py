"""Pushes as a system: exact impulses, nothing between control ticks, resets."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import PlannedPush, Scenario
from atlas_drake.diagrams.atlas_station import make_atlas_station, reset_station
from atlas_drake.messages import Behavior
from atlas_drake.systems.push_source import Push

PERIOD = 0.009
PUSH = PlannedPush(time=0.02, impulse=8.0, duration=0.025, frame="world")


@pytest.fixture(scope="module")
def station(robot):
    return make_atlas_station(robot, Scenario(pushes=[PUSH], initial_behavior="USER"))


def forces(station, root):
    """Forces on the plant along x [N]."""
    plant = station.GetSubsystemByName("plant")
    port = plant.get_applied_spatial_force_input_port()
    applied = port.Eval(plant.GetMyContextFromRoot(root))
    return [force.F_Bq_W.translational()[0] for force in applied]


def test_a_period_gets_the_mean_force_of_a_push():
    push = Push("utorso", np.array([90.0, 0.0, 0.0]), 0.012, 0.01)
    means = [push.mean_force(k * PERIOD, (k + 1) * PERIOD)[0] for k in range(4)]
    assert means == pytest.approx([0.0, 60.0, 40.0, 0.0], abs=1e-9)


def test_a_push_between_ticks_gives_its_whole_impulse(station):
    simulator = Simulator(station)
    source = station.GetSubsystemByName("push_source")
    simulator.AdvanceTo(0.0035)
    root = simulator.get_mutable_context()
    source.push(source.GetMyMutableContextFromRoot(root), "utorso", [2.0, 0, 0], 0.03)
    given, time = 0.0, 0.0035
    for tick in (1, 2, 3, 4):  # The planned push is the second of the forces.
        given += forces(station, root)[0] * (tick * PERIOD - time)
        time = tick * PERIOD
        simulator.AdvanceTo(time + 1e-5)
    assert given == pytest.approx(2.0 * 0.03, abs=1e-4)


def test_a_push_is_computed_once_a_tick_and_a_reset_ends_it_but_not_the_plan(station):
    simulator = Simulator(station)
    root = simulator.get_mutable_context()
    simulator.AdvanceTo(0.005)
    reset_station(station, root, Behavior.USER)
    simulator.Initialize()
    simulator.AdvanceTo(0.0305)
    source = station.GetSubsystemByName("push_source")
    own = source.GetMyContextFromRoot(root)
    entry = source.GetOutputPort("applied_spatial_force").cache_entry()
    assert forces(station, root) == pytest.approx([320.0])
    simulator.AdvanceTo(0.0345)
    assert not entry.is_out_of_date(own)
    reset_station(station, root, Behavior.USER)
    assert forces(station, root) == []
    simulator.Initialize()
    simulator.AdvanceTo(0.05)
    assert forces(station, root) == []
