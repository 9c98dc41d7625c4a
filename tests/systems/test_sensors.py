"""IMU, contact forces and encoders against the kinematics of the plant."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.control.attitude import turned
from atlas_drake.scenario import Start
from atlas_drake.systems.imu import InertialSensor
from atlas_drake.systems.sensor_noise import NOISE_MODELS
from atlas_drake.units import GRAVITY


@pytest.mark.slow
@pytest.mark.parametrize(("model", "noise"), [("atlas", "none"), ("atlas_v3", "rough")])
def test_the_sensors_measure_the_motion_of_the_robot(model, noise):
    sim = AtlasSimulation(Scenario(model=model, noise=noise))
    sim.advance(0.3)
    # A blow that turns the pelvis, too.
    sim.apply_push("l_farm", [80.0, 60.0, -40.0], 0.05)
    sim.advance(0.04)
    plant = sim.plant
    context = plant.GetMyContextFromRoot(sim.context)
    imu = plant.GetFrameByName(sim.robot.file.imu_frame)
    X_WI, V_WI = imu.CalcPoseInWorld(context), imu.CalcSpatialVelocityInWorld(context)
    accelerations = plant.get_body_spatial_accelerations_output_port().Eval(context)
    body = imu.body()
    X_WB = plant.EvalBodyPoseInWorld(context, body)
    A_WI = accelerations[int(body.index())].Shift(
        X_WB.rotation() @ imu.GetFixedPoseInBodyFrame().translation(),
        plant.EvalBodySpatialVelocityInWorld(context, body).rotational(),
    )
    upward = np.array([0.0, 0.0, 9.81])
    R_IW = X_WI.rotation().inverse().matrix()
    message = sim.imu
    assert np.abs(message.angular_velocity.to_array()).max() > 0.01
    sensors = sim.station.GetSubsystemByName("robot_sensors")
    own = sensors.GetMyContextFromRoot(sim.context)
    drawn = sensors.noise(own).sample(sim.time)
    measured = sensors.GetOutputPort("measured_state").Eval(own)
    indices, truth = sim.robot.indices(plant), sim.output("state")
    for found, expected, error in (
        (
            message.angular_velocity.to_array(),
            R_IW @ V_WI.rotational(),
            drawn.angular_velocity,
        ),
        (
            message.linear_acceleration.to_array(),
            R_IW @ (A_WI.translational() + upward),
            drawn.specific_force,
        ),
        (measured[indices.q], truth[indices.q], drawn.joint_position),
    ):
        assert error.any() == (noise == "rough")
        np.testing.assert_allclose(found, expected + error, atol=1e-9)
    np.testing.assert_allclose(
        message.orientation.to_wxyz(),
        X_WI.rotation().ToQuaternion().wxyz(),
        atol=1e-12,
    )


def test_the_soles_are_pressed_within_their_edges_wherever_the_robot_stands():
    sim = AtlasSimulation(Scenario(start=Start(position=[3.0, -2.0], yaw=1.0)))
    sim.advance(0.05)
    sole, report = sim.robot.file.sole, sim.atlas_state
    weight = sim.robot.mass * 9.81
    for wrench in (report.l_foot, report.r_foot):
        force, moment = wrench.force.to_array(), wrench.torque.to_array()
        assert force[2] > 0.2 * weight
        # m = r × f: the force acts at most half a diagonal from the sole's middle.
        reach = np.hypot(moment[0], moment[1]) / force[2]
        assert reach < 0.5 * np.hypot(sole.length, sole.width)
    for wrench in (report.l_hand, report.r_hand):
        assert not wrench.force.to_array().any()


TICK = 0.002
"""Control period of the inertial sensor below [s]."""
TURN = np.array([0.0, 0.1, 0.0])
"""Of the robot between two ticks, in the pelvis' axes [rad]."""


def test_the_inertial_sensor_measures_increments_since_the_last_tick():
    sim = AtlasSimulation()
    plant = sim.plant
    sensor = InertialSensor(sim.robot, plant, NOISE_MODELS["none"], 0, TICK / 2, TICK)
    simulator = Simulator(sensor)
    context = simulator.get_mutable_context()
    state = sim.output("state").copy()
    state[plant.num_positions() :] = 0.0

    def reading():
        sensor.GetInputPort("state").FixValue(context, state)
        return np.split(sensor.GetOutputPort("inertial").Eval(context), 3)

    # Zero before the first tick; at rest, gravity points upward.
    np.testing.assert_array_equal(reading(), np.zeros((3, 3)))
    simulator.AdvanceTo(TICK)
    rate, turn, velocity = reading()
    np.testing.assert_array_equal(rate, 0.0)
    np.testing.assert_allclose(turn, 0.0, atol=1e-12)
    np.testing.assert_allclose(velocity, [0.0, 0.0, GRAVITY * TICK], atol=1e-4)
    simulator.AdvanceTo(1.5 * TICK)
    orientation = sim.robot.indices(plant).pelvis.orientation
    state[orientation] = turned(state[orientation], TURN)
    state[plant.num_positions() + 3] = 0.2
    _, turn, velocity = reading()
    np.testing.assert_allclose(turn, TURN, atol=1e-9)
    # In the axes halfway, which are tilted by half of the turn.
    half, up = 0.5 * TURN[1], GRAVITY * 0.5 * TICK
    ahead = 0.2 * np.cos(half) - up * np.sin(half)
    np.testing.assert_allclose(velocity[0], ahead, atol=1e-3)
    sensor.reset(context)
    np.testing.assert_array_equal(np.concatenate(reading()[1:]), 0.0)


def test_the_noise_of_the_increments_is_that_of_the_imu_in_the_pelvis_axes():
    sim = AtlasSimulation()
    plant, robot = sim.plant, sim.robot
    sensor = InertialSensor(robot, plant, NOISE_MODELS["rough"], 3, TICK / 2, TICK)
    simulator = Simulator(sensor)
    context = simulator.get_mutable_context()
    state = sim.output("state").copy()
    state[plant.num_positions() :] = 0.0
    sensor.GetInputPort("state").FixValue(context, state)
    simulator.AdvanceTo(1.5 * TICK)
    reading = sensor.GetOutputPort("inertial").Eval(context)
    drawn = sensor.noise(context).sample(context.get_time())
    imu = plant.GetFrameByName(robot.file.imu_frame)
    R_PI = imu.GetFixedPoseInBodyFrame().rotation().matrix()
    gyro, force = R_PI @ drawn.angular_velocity, R_PI @ drawn.specific_force
    dt = 0.5 * TICK
    np.testing.assert_allclose(reading[:3], gyro, atol=1e-12)
    np.testing.assert_allclose(reading[3:6], dt * gyro, atol=1e-12)
    velocity = dt * (np.array([0.0, 0.0, GRAVITY]) + force)
    np.testing.assert_allclose(reading[6:], velocity, atol=1e-5)
