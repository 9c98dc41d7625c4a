"""The IMU for a state estimator: its increments since the last control tick.

A station has this sensor only with an estimator; ``robot_sensors`` makes the ``Imu``
message with the values of an instant.
"""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context, DiscreteValues

from atlas_drake.control.estimation.attitude import (
    rotation_matrix,
    turn_between,
    turned,
)
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.robot import Robot
from atlas_drake.scenario.noise import NoiseModel, SensorNoise
from atlas_drake.systems.noisy_system import NoisySystem

_UNSET = -1.0
"""Time of the last tick before the first tick."""


class InertialSensor(NoisySystem):
    """The plant's state in, increments of a strapdown IMU out.

    Like a navigation-grade inertial sensor, it integrates internally at a rate far
    above that of the control ticks. So no motion between two ticks is lost, not even an
    impact, and no acceleration is needed before the plant's step at this instant is
    solved: the integral of acceleration is the change of velocity.

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
        self._last = self.DeclareDiscreteState(_nothing())
        self.DeclareVectorOutputPort("inertial", 9, self._calc_inertial)
        self.DeclarePeriodicDiscreteUpdateEvent(control_period, 0.0, self._update)

    def reset(self, context: Context) -> None:
        """Clears the last tick, after the robot was placed."""
        context.SetDiscreteState(self._last, _nothing())

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

    def _calc_inertial(self, context: Context, output: BasicVector) -> None:
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
        output.SetFromVector(np.concatenate([rate, turn, velocity]))


def _nothing() -> np.ndarray:
    """Returns the state before the first tick, shape (8,)."""
    return np.array([_UNSET, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
