"""The strapdown IMU alone: its increments between two ticks."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation
from atlas_drake.control.estimation.attitude import turned
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.scenario.noise import NOISE_MODELS
from atlas_drake.systems.imu import InertialSensor

TICK = 0.002
"""[s]"""
TURN = np.array([0.0, 0.1, 0.0])
"""Of the robot between two ticks, in the pelvis' axes [rad]."""


@pytest.fixture(scope="module")
def sim():
    return AtlasSimulation()


@pytest.fixture
def simulator(sim):
    """Of a sensor that is fed with the state of a robot that stands still."""
    sensor = InertialSensor(
        sim.robot, sim.plant, NOISE_MODELS["none"], 0, 0.5 * TICK, TICK
    )
    simulator = Simulator(sensor)
    state = sim.output("state").copy()
    state[sim.plant.num_positions() :] = 0.0
    feed(simulator, state)
    return simulator


def feed(simulator, state):
    sensor, context = simulator.get_system(), simulator.get_mutable_context()
    sensor.GetInputPort("state").FixValue(context, state)


def reading(simulator):
    """Rate, rotation and the integral of the specific force."""
    port = simulator.get_system().GetOutputPort("inertial")
    return np.split(port.Eval(simulator.get_context()), 3)


def test_increments_are_zero_before_the_first_tick(simulator):
    for part in reading(simulator):
        np.testing.assert_array_equal(part, 0.0)


def test_at_rest_the_velocity_increment_is_gravity_upward(simulator):
    simulator.AdvanceTo(TICK)
    rate, turn, velocity = reading(simulator)
    np.testing.assert_array_equal(rate, 0.0)
    np.testing.assert_allclose(turn, 0.0, atol=1e-12)
    np.testing.assert_allclose(velocity, [0.0, 0.0, GRAVITY * TICK], atol=1e-4)


def test_increments_are_turn_and_velocity_change_since_the_last_tick(sim, simulator):
    simulator.AdvanceTo(0.5 * TICK)
    orientation = sim.robot.indices(sim.plant).pelvis.orientation
    state = sim.output("state").copy()
    state[sim.plant.num_positions() :] = 0.0
    state[orientation] = turned(state[orientation], TURN)
    state[sim.plant.num_positions() + 3] = 0.2
    feed(simulator, state)
    _, turn, velocity = reading(simulator)
    np.testing.assert_allclose(turn, TURN, atol=1e-9)
    # In the axes halfway, which are tilted by half of the turn.
    half, up = 0.5 * TURN[1], GRAVITY * 0.5 * TICK
    ahead = 0.2 * np.cos(half) - up * np.sin(half)
    np.testing.assert_allclose(velocity[0], ahead, atol=1e-3)
    simulator.get_system().reset(simulator.get_mutable_context())
    np.testing.assert_array_equal(np.concatenate(reading(simulator)[1:]), 0.0)
