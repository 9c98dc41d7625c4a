"""Messages of IMU and contact forces against the kinematics of the plant."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.scenario import Start


@pytest.mark.parametrize(("model", "noise"), [("atlas", "none"), ("atlas_v3", "rough")])
def test_the_imu_measures_the_motion_of_its_frame(model, noise):
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
    source = sensors.noise(sensors.GetMyContextFromRoot(sim.context))
    drawn = source.sample(sim.time)
    for found, expected, error in (
        (message.angular_velocity, R_IW @ V_WI.rotational(), drawn.angular_velocity),
        (
            message.linear_acceleration,
            R_IW @ (A_WI.translational() + upward),
            drawn.specific_force,
        ),
    ):
        assert error.any() == (noise == "rough")
        np.testing.assert_allclose(found.to_array(), expected + error, atol=1e-9)
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


def test_joints_are_measured_with_the_noise_of_their_encoders():
    sim = AtlasSimulation(Scenario(noise="rough", seed=3))
    sim.advance(0.03)
    sensors = sim.station.GetSubsystemByName("robot_sensors")
    context = sensors.GetMyContextFromRoot(sim.context)
    measured = sensors.GetOutputPort("measured_state").Eval(context)
    truth = sensors.GetInputPort("state").Eval(context)
    drawn = sensors.noise(context).sample(sim.time)
    indices = sim.robot.indices(sim.plant)
    joints = measured[indices.q] - truth[indices.q]
    np.testing.assert_allclose(joints, drawn.joint_position, atol=1e-12)
    assert drawn.joint_position.any()
