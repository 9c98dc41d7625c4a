"""The IMU on the pelvis: values of an instant, and increments for an estimator."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.control.attitude import (
    composed,
    turn_between,
    turned,
)
from atlas_drake.robot import Robot
from atlas_drake.rotations import cross, rotation_matrix
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.sensor_noise import NoiseModel, SensorNoise
from atlas_drake.units import GRAVITY

_UPWARD = np.array([0.0, 0.0, GRAVITY])
"""Specific force of a body at rest, in W [m/s²]."""
_UNSET = -1.0
"""Time of the last tick before the first tick."""
_AT_START = np.array([_UNSET, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


class NoisySystem(CollectableSystem):
    """A system that adds noise, a parameter in its Context, to its measurements."""

    __slots__ = ()

    def declare_noise(self, noise: SensorNoise) -> None:
        """Declares the parameter, with the noise of the default context."""
        self._noise_index = self.DeclareAbstractParameter(AbstractValue.Make(noise))

    def set_seed(self, context: Context, seed: int) -> None:
        """Draws the noise from another seed, 0 to 2**64 - 1, from now on."""
        parameter: Any = context.get_mutable_abstract_parameter(self._noise_index)
        parameter.set_value(self.noise(context).with_seed(seed))

    def noise(self, context: Context) -> SensorNoise:
        """Returns the noise in force."""
        parameter: Any = context.get_abstract_parameter(self._noise_index)
        return parameter.get_value()


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
        """Computes orientation (w first), angular velocity and specific force in I."""
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


class InertialSensor(NoisySystem):
    """The plant's state in, increments of a strapdown IMU out.

    Like a navigation-grade inertial sensor, it integrates internally at a rate far
    above that of the control ticks. So no motion between two ticks is lost, not even an
    impact, and no acceleration is needed before the plant's step at this instant is
    solved: the integral of acceleration is the change of velocity. A station has this
    sensor only with an estimator.

    Input ports:
        state: Positions and velocities of the robot.

    Output ports:
        inertial: In the pelvis' axes, shape (9,): the present angular velocity [rad/s],
            the rotation since the last tick [rad], and the integral of the specific
            force since the last tick [m/s], in the axes halfway. Rotation and integral
            are zero before the first tick.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        noise: NoiseModel,
        seed: int,
        physics_step: float,
        control_period: float,
    ):
        """Measures ``robot`` in ``plant`` with the noise model of ``RobotSensors``."""
        super().__init__()
        self._plant = plant
        self.declare_noise(SensorNoise(noise, seed, robot.num_joints, physics_step))
        self._instance = own = robot.instance(plant)
        imu = plant.GetFrameByName(robot.file.imu_frame, own)
        # An index, because a frame holds its plant where the garbage collector cannot
        # see it.
        self._imu = imu.index()
        self._R_PI = imu.GetFixedPoseInBodyFrame().rotation().matrix()
        self._orientation = robot.indices(plant).pelvis.orientation
        self._state = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        # At the last tick: its time, the pelvis' quaternion, the IMU's velocity in W.
        self._last = self.DeclareDiscreteState(_AT_START)
        self.declare_vector_output("inertial", 9, self._increments)
        self.DeclarePeriodicDiscreteUpdateEvent(control_period, 0.0, self._update)

    def reset(self, context: Context) -> None:
        """Clears the last tick, after the robot was placed."""
        context.SetDiscreteState(self._last, _AT_START)

    def _motion(self, context: Context) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Computes the pelvis' quaternion, and the IMU's angular and linear velocity.

        All are in W.
        """
        state, scratch = self._state.Eval(context), self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(scratch, self._instance, state)
        V_WI = self._plant.get_frame(self._imu).CalcSpatialVelocityInWorld(scratch)
        return state[self._orientation], V_WI.rotational(), V_WI.translational()

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        q_WP, _, v_WI = self._motion(context)
        now = np.concatenate([[context.get_time()], q_WP, v_WI])
        discrete.get_mutable_vector(self._last).SetFromVector(now)

    def _increments(self, context: Context) -> np.ndarray:
        q_WP, w_WP, v_WI = self._motion(context)
        last = context.get_discrete_state(self._last).value()
        rate = rotation_matrix(q_WP).T @ w_WP
        turn, velocity, dt = np.zeros(3), np.zeros(3), 0.0
        if last[0] != _UNSET:
            dt = context.get_time() - last[0]
            turn = turn_between(last[1:5], q_WP)
            halfway = rotation_matrix(turned(last[1:5], 0.5 * turn))
            gained = v_WI - last[5:]
            gained[2] += GRAVITY * dt
            velocity = halfway.T @ gained
        if not self.noise(context).silent:
            # One sample for the interval between two ticks, which overestimates noise.
            noise = self.noise(context).sample(context.get_time())
            gyro = self._R_PI @ noise.angular_velocity
            rate = rate + gyro
            turn = turn + dt * gyro
            velocity = velocity + dt * (self._R_PI @ noise.specific_force)
        return np.concatenate([rate, turn, velocity])
