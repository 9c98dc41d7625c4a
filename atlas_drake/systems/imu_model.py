"""What an ideal or noisy IMU on the pelvis measures, from the motion of the robot."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.control.estimation.attitude import composed, rotation_matrix
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.robot import Robot
from atlas_drake.rotations import cross
from atlas_drake.scenario.noise import SensorNoise

_UPWARD = np.array([0.0, 0.0, GRAVITY])
"""Specific force of a body at rest, in W [m/s²]."""


class ImuModel:
    """The IMU of a robot in a plant. It has no state."""

    def __init__(self, robot: Robot, plant: MultibodyPlant) -> None:
        """Takes the place of the IMU on the pelvis."""
        own = robot.instance(plant)
        X_PI = plant.GetFrameByName(robot.file.imu_frame, own).GetFixedPoseInBodyFrame()
        self._q_PI = X_PI.rotation().ToQuaternion().wxyz()
        self.R_PI = X_PI.rotation().matrix()
        self._p_PI_I = self.R_PI.T @ X_PI.translation()
        indices = robot.indices(plant)
        self._orientation = indices.pelvis.orientation
        self._base = indices.generalized[:6]
        self.w = plant.num_positions(own) + self._base[:3]

    def measure(
        self,
        state: np.ndarray,
        acceleration: np.ndarray,
        noise: SensorNoise,
        time: float,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Computes a measurement.

        Args:
            state: True positions and velocities of the robot.
            acceleration: Its generalized accelerations.
            noise: Noise of the sensors.
            time: Time of the measurement [s].

        Returns:
            Orientation of the IMU in W as a quaternion with w first, angular velocity
            [rad/s] and specific force [m/s²] in the IMU's frame.
        """
        w_WP = state.take(self.w)
        base = acceleration.take(self._base)
        alpha_WP, a_WP = base[:3], base[3:]
        # Of unit length; the plant's quaternion drifts from that by some 1e-4.
        q_WI = composed(state[self._orientation], self._q_PI)
        R_WI = rotation_matrix(q_WI)
        p_PI_W = R_WI @ self._p_PI_I
        a_WI = a_WP + cross(alpha_WP, p_PI_W) + cross(w_WP, cross(w_WP, p_PI_W))
        rate = R_WI.T @ w_WP
        force = R_WI.T @ (a_WI + _UPWARD)
        if not noise.silent:
            sample = noise.sample(time)
            rate = rate + sample.angular_velocity
            force = force + sample.specific_force
        return q_WI, rate, force
