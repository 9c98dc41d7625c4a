"""The estimator in its diagram: inputs, their timing, and state in the Context."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.control.estimation.attitude import rotation_matrix, turned
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.scenario import Start
from atlas_drake.systems.run_statistics import error_sizes
from atlas_drake.systems.state_estimator import StateEstimator

TICK = Scenario().resolved().control_period
"""Control period of the default scenario [s]."""
ESTIMATED = Scenario(state="estimated", noise="rough", seed=4)


def names(station):
    return {system.get_name() for system in station.GetSystems()}


def test_a_station_on_the_true_state_has_no_estimator(robot):
    plain = make_atlas_station(robot)
    estimated = make_atlas_station(robot, Scenario(state="estimated"))
    more = {"inertial_sensor", "state_estimator", "estimation_error"}
    assert names(estimated) - names(plain) == more
    assert not plain.HasOutputPort("estimation_error")


@pytest.fixture
def alone(robot):
    """An estimator without a diagram, and the context that feeds it."""
    estimator = StateEstimator(robot, TICK)
    context = estimator.CreateDefaultContext()
    sim = AtlasSimulation()
    state = sim.output("state")
    weight = robot.mass * 9.81
    feed = {
        "measured_state": state,
        "start_state": state,
        "inertial": np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.81 * TICK]),
        "foot_loads": np.full(2, 0.5 * weight),
    }
    for name, value in feed.items():
        estimator.GetInputPort(name).FixValue(context, value)
    return estimator, context, state


def test_the_start_state_is_read_at_the_first_tick_only(alone, robot):
    estimator, context, state = alone
    port = estimator.GetOutputPort("estimated_state")
    np.testing.assert_allclose(port.Eval(context), state, atol=1e-12)
    simulator = Simulator(estimator, context)
    simulator.AdvanceTo(TICK)
    # From now on nothing is read that a robot cannot measure.
    nonsense = np.full(state.shape, np.nan)
    estimator.GetInputPort("start_state").FixValue(context, nonsense)
    joints_only = nonsense.copy()
    measured = robot.indices(estimator._plant)
    joints_only[measured.q] = state[measured.q]
    offset = estimator._plant.num_positions()
    joints_only[offset + measured.v] = state[offset + measured.v]
    estimator.GetInputPort("measured_state").FixValue(context, joints_only)
    simulator.AdvanceTo(25 * TICK)
    np.testing.assert_allclose(port.Eval(context), state, atol=1e-6)


def test_the_estimate_starts_with_the_robots_velocity(alone):
    estimator, context, state = alone
    moving = state + np.random.default_rng(6).uniform(-0.5, 0.5, state.shape)
    moving[:4] = turned(state[:4], np.array([0.3, -0.2, 1.0]))
    pelvis = estimator._pelvis
    turning = rotation_matrix(moving[:4]).T @ moving[pelvis.angular_velocity]
    for name, value in (
        ("measured_state", moving),
        ("start_state", moving),
        ("inertial", np.append(turning, np.zeros(6))),
    ):
        estimator.GetInputPort(name).FixValue(context, value)
    estimate = estimator.GetOutputPort("estimated_state").Eval(context)
    np.testing.assert_allclose(estimate, moving, atol=1e-9)


def test_leg_kinematics_equal_those_in_the_world(alone):
    # Everything moves, the pelvis too, whose own velocity no leg can tell.
    estimator, context, state = alone
    plant = estimator._plant
    random = np.random.default_rng(5)
    moving = state + random.uniform(-0.5, 0.5, state.shape)
    moving[:4] = turned(state[:4], np.array([0.3, -0.2, 1.0]))
    estimator.GetInputPort("measured_state").FixValue(context, moving)
    truth = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(truth, moving)
    R_WP = rotation_matrix(moving[:4])
    imu = plant.GetFrameByName("imu")
    p_WI, V_WI = imu.CalcPoseInWorld(truth), imu.CalcSpatialVelocityInWorld(truth)
    positions, velocities = estimator._legs(context, R_WP.T @ V_WI.rotational())
    for foot, name in enumerate(("l_sole", "r_sole")):
        sole = plant.GetFrameByName(name)
        p_IF = sole.CalcPoseInWorld(truth).translation() - p_WI.translation()
        V_WF = sole.CalcSpatialVelocityInWorld(truth)
        v_IF = V_WF.translational() - V_WI.translational()
        np.testing.assert_allclose(R_WP @ positions[foot], p_IF, atol=1e-12)
        np.testing.assert_allclose(R_WP @ velocities[foot], v_IF, atol=1e-12)


def test_only_a_loaded_foot_corrects_the_position(alone, robot):
    estimator, context, state = alone
    plant = estimator._plant
    # The right knee bends: either its foot moves, or the robot.
    bent = state.copy()
    bent[robot.indices(plant).q[robot.joint_names.index("r_leg_kny")]] += 0.05
    weight = robot.mass * 9.81
    found = []
    for right in (0.0, 0.02, 0.5):
        loads = weight * np.array([1.0 - right, right])
        estimator.reset(context)
        estimator.GetInputPort("measured_state").FixValue(context, state)
        context.SetTime(0.0)
        simulator = Simulator(estimator, context)
        simulator.AdvanceTo(TICK)
        estimator.GetInputPort("foot_loads").FixValue(context, loads)
        estimator.GetInputPort("measured_state").FixValue(context, bent)
        simulator.AdvanceTo(2 * TICK)
        estimate = estimator.GetOutputPort("estimated_state").Eval(context)
        found.append(estimate[4:7] - state[4:7])
    unloaded, touching, carrying = found
    np.testing.assert_array_equal(touching, unloaded)
    assert np.linalg.norm(carrying - unloaded) > 1e-6


@pytest.fixture(scope="module")
def running():
    """A robot on the estimate with every kind of noise, a little after its start."""
    sim = AtlasSimulation(ESTIMATED)
    sim.advance(25 * TICK)
    return sim


def test_at_one_instant_there_is_one_estimate(running):
    # The controller asks before the estimator's own update, the report after it.
    sim = Simulator(running.diagram, running.context.Clone())
    context = sim.get_mutable_context()
    port = running.diagram.GetOutputPort("estimated_state")
    begin = port.Eval(context)
    sim.AdvanceTo(context.get_time() + TICK)
    at, before = context.get_time(), port.Eval(context)
    assert before.tobytes() != begin.tobytes()
    sim.AdvancePendingEvents()
    assert context.get_time() == at
    # The updates changed where the robot will be, but asked after them, the plant's
    # state is a step ahead at the same time: only what was remembered can be compared.
    np.testing.assert_array_equal(port.Eval(context)[:7], before[:7])


def test_the_reported_positions_are_the_estimate(running):
    estimate = running.output("estimated_state")
    report = running.atlas_sim_interface_state
    position = report.pos_est.position.to_array()
    np.testing.assert_array_equal(position, estimate[4:7])
    assert 1e-6 < np.linalg.norm(position - running.pelvis_pose.translation()) < 5e-3
    plant = running.plant
    context = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, estimate)
    for foot, pose in zip(running.robot.file.feet, report.foot_pos_est, strict=True):
        sole = plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        np.testing.assert_allclose(
            pose.position.to_array(), sole.translation(), atol=1e-12
        )


def test_the_error_is_that_between_estimate_and_truth(running):
    true, estimate = running.output("state"), running.output("estimated_state")
    error = running.output("estimation_error")
    np.testing.assert_allclose(error[:3], (estimate - true)[4:7], atol=1e-15)
    velocities = running.plant.num_positions() + np.arange(3, 6)
    np.testing.assert_allclose(error[3:6], (estimate - true)[velocities], atol=1e-15)
    R_WE = rotation_matrix(estimate[:4]) @ rotation_matrix(true[:4]).T
    turn = 0.5 * np.array([R_WE[2, 1], R_WE[0, 2], R_WE[1, 0]])
    turn -= 0.5 * np.array([R_WE[1, 2], R_WE[2, 0], R_WE[0, 1]])
    # Both are the angle to first order.
    np.testing.assert_allclose(error[6:], turn, atol=1e-8)
    drift = running.summary()["estimator_drift"]
    assert list(drift["final"].values()) == pytest.approx(error_sizes(error))
    for name, value in drift["largest"].items():
        assert 0.0 < value < 0.02
        assert value >= 0.9 * drift["final"][name]


@pytest.mark.slow
def test_the_imu_integrates_to_the_motion_and_has_the_bias_of_its_message():
    sim = AtlasSimulation(Scenario(state="estimated", noise="reference"))
    sensor = sim.station.GetSubsystemByName("inertial_sensor")
    port, context = sensor.GetOutputPort("inertial"), sim.context
    felt, biased = [], []
    first, share = 250, 0.99
    for tick in range(first, first + 50):
        # Shortly before the next tick.
        sim.advance_to((tick + share) * TICK)
        felt.append(port.Eval(sensor.GetMyContextFromRoot(context)))
        biased.append(sim.imu.linear_acceleration.to_array())
    mean = np.mean(felt, axis=0)[6:] / (share * TICK)
    # Hardly moving, both feel gravity and the same bias.
    np.testing.assert_allclose(mean, np.mean(biased, axis=0), atol=0.01)
    assert np.linalg.norm(mean) != pytest.approx(9.81, abs=0.01)


def test_a_reset_of_the_simulation_puts_the_estimate_where_the_robot_is():
    sim = AtlasSimulation(ESTIMATED)
    sim.advance(0.05)
    sim.reset(pose=Start(position=[2.0, -1.0], yaw=0.5))
    assert error_sizes(sim.output("estimation_error")).max() < 1e-4
    sim.advance(0.3)
    assert error_sizes(sim.output("estimation_error")).max() < 0.02
    position = sim.atlas_sim_interface_state.pos_est.position
    assert [position.x, position.y] == pytest.approx([2.0, -1.0], abs=0.05)
    # Nothing that was felt on the way counts as an error.
    assert sim.summary()["estimator_drift"]["largest"]["position_m"] < 0.01


def test_a_run_on_the_true_state_reports_no_drift():
    assert "estimator_drift" not in AtlasSimulation().summary()
