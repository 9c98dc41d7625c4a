"""The estimator in its diagram: inputs, their timing, and state in the Context."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.control.attitude import turned
from atlas_drake.parts.estimation.estimation_error import error_sizes
from atlas_drake.parts.estimation.state_estimator import StateEstimator
from atlas_drake.rotations import rotation_matrix
from atlas_drake.scenario import Start

TICK = Scenario().resolved().control_period
"""Control period of the default scenario [s]."""
ESTIMATED = Scenario(state="estimated", noise="rough", seed=4)


class Alone:
    """An estimator without a diagram, and the context that feeds it."""

    def __init__(self, robot, state):
        self.system = StateEstimator(robot, TICK)
        self.context = self.system.CreateDefaultContext()
        inertial = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.81 * TICK]
        self.feed(measured_state=state, start_state=state, inertial=inertial)
        self.feed(foot_loads=np.full(2, 0.5 * robot.mass * 9.81))

    def feed(self, **inputs):
        for name, value in inputs.items():
            self.system.GetInputPort(name).FixValue(self.context, value)

    @property
    def estimate(self):
        return self.system.GetOutputPort("estimated_state").Eval(self.context)


@pytest.fixture(scope="module")
def state():
    return AtlasSimulation().output("state")


@pytest.fixture
def alone(robot, state):
    return Alone(robot, state)


def test_the_start_state_is_read_at_the_first_tick_only(alone, robot, state):
    np.testing.assert_allclose(alone.estimate, state, atol=1e-12)
    simulator = Simulator(alone.system, alone.context)
    simulator.AdvanceTo(TICK)
    # From now on nothing is read that a robot cannot measure.
    nonsense = np.full(state.shape, np.nan)
    joints_only, indices = nonsense.copy(), robot.indices(robot.plant)
    velocities = robot.plant.num_positions() + indices.v
    for joints in (indices.q, velocities):
        joints_only[joints] = state[joints]
    alone.feed(start_state=nonsense, measured_state=joints_only)
    simulator.AdvanceTo(25 * TICK)
    np.testing.assert_allclose(alone.estimate, state, atol=1e-6)


def test_a_moving_robot_is_read_from_its_start_and_its_legs(alone, robot, state):
    # Everything moves, the pelvis too, whose own velocity no leg can tell.
    moving = state + np.random.default_rng(6).uniform(-0.5, 0.5, state.shape)
    moving[:4] = turned(state[:4], np.array([0.3, -0.2, 1.0]))
    plant = robot.plant
    pelvis = robot.indices(plant).pelvis
    R_WP = rotation_matrix(moving[:4])
    turning = R_WP.T @ moving[pelvis.angular_velocity]
    alone.feed(measured_state=moving, start_state=moving)
    alone.feed(inertial=np.append(turning, np.zeros(6)))
    np.testing.assert_allclose(alone.estimate, moving, atol=1e-9)
    truth = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(truth, moving)
    imu = plant.GetFrameByName("imu")
    p_WI, V_WI = imu.CalcPoseInWorld(truth), imu.CalcSpatialVelocityInWorld(truth)
    positions, velocities = alone.system.legs(alone.context, turning)
    for foot, name in enumerate(("l_sole", "r_sole")):
        sole = plant.GetFrameByName(name)
        p_IF = sole.CalcPoseInWorld(truth).translation() - p_WI.translation()
        V_WF = sole.CalcSpatialVelocityInWorld(truth)
        v_IF = V_WF.translational() - V_WI.translational()
        np.testing.assert_allclose(R_WP @ positions[foot], p_IF, atol=1e-12)
        np.testing.assert_allclose(R_WP @ velocities[foot], v_IF, atol=1e-12)


def test_only_a_loaded_foot_corrects_the_position(alone, robot, state):
    # The right knee bends: either its foot moves, or the robot.
    bent = state.copy()
    knee = robot.joint_index("r_leg_kny")
    bent[robot.indices(robot.plant).q[knee]] += 0.05
    found = []
    for right in (0.0, 0.02, 0.5):
        alone.system.reset(alone.context)
        alone.context.SetTime(0.0)
        alone.feed(measured_state=state)
        simulator = Simulator(alone.system, alone.context)
        simulator.AdvanceTo(TICK)
        loads = robot.mass * 9.81 * np.array([1.0 - right, right])
        alone.feed(foot_loads=loads, measured_state=bent)
        simulator.AdvanceTo(2 * TICK)
        found.append(alone.estimate[4:7] - state[4:7])
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


def test_the_reports_are_of_the_estimate_and_its_error(running):
    true, estimate = running.output("state"), running.output("estimated_state")
    report = running.atlas_sim_interface_state
    position = report.pos_est.position.to_array()
    np.testing.assert_array_equal(position, estimate[4:7])
    assert 1e-6 < np.linalg.norm(position - true[4:7]) < 5e-3
    plant = running.plant
    context = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, estimate)
    for foot, pose in zip(running.robot.file.feet, report.foot_pos_est, strict=True):
        sole = plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        np.testing.assert_allclose(
            pose.position.to_array(), sole.translation(), atol=1e-12
        )
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


def test_a_reset_of_the_simulation_puts_the_estimate_where_the_robot_is():
    sim = AtlasSimulation(ESTIMATED)
    sim.advance(0.05)
    sim.reset(pose=Start(position=[2.0, -1.0], yaw=0.5))
    assert error_sizes(sim.output("estimation_error")).max() < 1e-4
    sim.advance(0.1)
    assert error_sizes(sim.output("estimation_error")).max() < 0.02
    position = sim.atlas_sim_interface_state.pos_est.position
    assert [position.x, position.y] == pytest.approx([2.0, -1.0], abs=0.05)
    # Nothing that was felt on the way counts as an error.
    assert sim.summary()["estimator_drift"]["largest"]["position_m"] < 0.01


def test_the_sizes_of_an_error_are_distance_speed_tilt_and_yaw():
    error = np.array([2.0, 3.0, -6.0, 1.0, -4.0, 8.0, 0.3, -0.4, -0.7])
    assert error_sizes(error) == pytest.approx([7.0, 9.0, 0.5, 0.7])
