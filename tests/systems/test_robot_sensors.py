"""The IMU's message against Drake's own kinematics of the plant."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario


@pytest.mark.parametrize("model", ["atlas", "atlas_v3"])
@pytest.mark.parametrize("noise", ["none", "rough"])
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
