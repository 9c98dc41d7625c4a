"""The IMU's message against Drake's own kinematics of the plant."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario


@pytest.mark.parametrize("model", ["atlas", "atlas_v3"])
def test_the_imu_measures_the_motion_of_its_frame(model):
    sim = AtlasSimulation(Scenario(model=model))
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
    for found, expected in (
        (message.angular_velocity, R_IW @ V_WI.rotational()),
        (message.linear_acceleration, R_IW @ (A_WI.translational() + upward)),
    ):
        np.testing.assert_allclose(found.to_array(), expected, atol=1e-9)
    np.testing.assert_allclose(
        message.orientation.to_wxyz(),
        X_WI.rotation().ToQuaternion().wxyz(),
        atol=1e-12,
    )
