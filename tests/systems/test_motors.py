"""Efforts of the behaviors on their way to the motors: late, and with noise."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.frozen import NOTHING
from atlas_drake.systems.sensor_noise import NoiseModel

STEP = Scenario.physics_step


def sent_and_received(sim, steps):
    """The behavior's efforts and those of the motors, after each physics step.

    Beside each, the speeds that the motors shall hold.
    """

    def values(part, effort, hold):
        system, context = sim.part(part)
        ports = (system.GetOutputPort(name) for name in (effort, hold))
        efforts, held = (port.Eval(context) for port in ports)
        # Before its first tick a controller has none.
        speeds = np.zeros_like(efforts) if held is NOTHING else held.speed
        return np.concatenate([efforts, speeds])

    sent, received = [], []
    for _ in range(steps):
        sim.advance(STEP)
        sent.append(values("controller", "behavior_effort", "speed_hold"))
        received.append(values("motors", "received_effort", "received_hold"))
    return np.array(sent), np.array(received)


@pytest.mark.parametrize("steps", [1, 6])
def test_a_delay_is_that_of_every_effort_and_speed(steps):
    sim = AtlasSimulation(Scenario(effort_delay=steps * STEP))
    sim.apply_push("trunk", [200.0, 0.0, 0.0], 0.1)
    sent, received = sent_and_received(sim, 40)
    assert np.ptp(sent, axis=0).max() > 10.0
    np.testing.assert_array_equal(received[steps:], sent[:-steps])
    assert not sim.has_fallen


@pytest.mark.slow
def test_noise_is_a_share_of_the_limits_drawn_from_the_seed():
    def run(seed):
        sim.reset(seed=seed)
        sent, received = sent_and_received(sim, 300)
        n = sim.robot.num_joints
        noise = (received - sent)[:, :n] / sim.robot.effort_limit
        return received, noise

    sim = AtlasSimulation(Scenario(noise=NoiseModel(effort=0.002)))
    efforts, noise = run(seed=4)
    assert noise.std() == pytest.approx(0.002, rel=0.1)
    np.testing.assert_array_equal(run(seed=4)[0], efforts)
    assert not np.array_equal(run(seed=5)[1], noise)


def test_efforts_on_their_way_are_forgotten_at_a_reset():
    sim = AtlasSimulation(Scenario(effort_delay=6 * STEP))
    first = sent_and_received(sim, 20)
    sim.reset(seed=0)
    np.testing.assert_array_equal(sent_and_received(sim, 20), first)


def test_exact_motors_add_no_system():
    station = AtlasSimulation(Scenario(noise="rough")).station
    assert not station.HasSubsystemNamed("motors")
