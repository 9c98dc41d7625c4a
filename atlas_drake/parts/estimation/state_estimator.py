"""Estimates the robot's state from IMU, joint encoders and loads on the feet.

The filter is ``parts.estimation.leg_odometry``; this is its system in the diagram.
"""

from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Context, State

from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.frozen import Frozen
from atlas_drake.parts.estimation.leg_odometry import (
    OdometryState,
    OdometryTuning,
    correct,
    predict,
    start_odometry,
)
from atlas_drake.robot import Robot
from atlas_drake.rotations import cross, rotation_matrix
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.units import GRAVITY


@dataclass(frozen=True)
class EstimatorState(Frozen):
    """Time [s] and state of the filter at the last tick; None without a tick."""

    time: float = 0.0
    odometry: OdometryState | None = None


class StateEstimator(CollectableSystem):
    """Measurements in, the state of the whole robot out.

    The estimate is a function of the state at the last tick and of the present
    measurements, so that the controller's update, at the same instant as the update of
    this system, already uses the present measurements.

    Input ports:
        measured_state: Measured state in plant order, of which only the joints are
            read.
        inertial: Output of ``InertialSensor``, shape (9,).
        foot_loads: Vertical forces on left and right foot [N], shape (2,), one control
            tick ago.
        start_state: Known initial state, in plant order; read only at the first tick,
            and at the first tick after a reset.

    Output ports:
        estimated_state: Estimated state in plant order, with the measured joints.
    """

    __slots__ = ()

    def __init__(
        self, robot: Robot, period: float, tuning: OdometryTuning | None = None
    ):
        """Runs every ``period`` [s]."""
        super().__init__()
        self._tuning = tuning or OdometryTuning()
        self._weight = robot.mass * GRAVITY
        self._plant = plant = WholeBodyModel(robot).plant
        self._pelvis = robot.indices(plant).pelvis
        self._imu = plant.GetFrameByName(robot.file.imu_frame)
        self._p_PI = self._imu.GetFixedPoseInBodyFrame().translation()
        self._soles = [plant.GetFrameByName(f.sole_frame) for f in robot.file.feet]
        size = plant.num_multibody_states()
        self._measured = self.DeclareVectorInputPort("measured_state", size)
        self._inertial = self.DeclareVectorInputPort("inertial", 9)
        self._loads = self.DeclareVectorInputPort("foot_loads", 2)
        self._start = self.DeclareVectorInputPort("start_state", size)
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        self._state = self.declare_value_state(EstimatorState())
        self._odometry = self.declare_cached("odometry", self._present)
        self.declare_vector_output("estimated_state", size, self._estimate)
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def reset(self, context: Context) -> None:
        """Starts again from the present ``start_state``."""
        self._state.set(context, EstimatorState())

    def _update(self, context: Context, state: State) -> None:
        after = EstimatorState(context.get_time(), self._odometry.Eval(context))
        self._state.set(state, after)

    def _present(self, context: Context) -> OdometryState:
        before: EstimatorState = self._state.get(context)
        if before.odometry is None:
            return self._begin(context)
        dt = context.get_time() - before.time
        # dt is 0 for a read at the instant of the tick, after its update.
        return self._follow(context, before.odometry, dt) if dt > 0 else before.odometry

    def _begin(self, context: Context) -> OdometryState:
        start, scratch = self._start.Eval(context), self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(scratch, start)
        soles = [sole.CalcPoseInWorld(scratch).translation() for sole in self._soles]
        return start_odometry(
            start[self._pelvis.orientation],
            self._imu.CalcPoseInWorld(scratch).translation(),
            self._imu.CalcSpatialVelocityInWorld(scratch).translational(),
            np.array(soles),
            self._tuning,
        )

    def _follow(
        self, context: Context, before: OdometryState, dt: float
    ) -> OdometryState:
        inertial = self._inertial.Eval(context)
        after = predict(before, inertial[3:6], inertial[6:], dt, self._tuning)
        p_IF_P, v_IF_P = self.legs(context, inertial[:3])
        R_PW = rotation_matrix(after.q_WP).T
        load = self._loads.Eval(context) / self._weight
        return correct(after, p_IF_P @ R_PW, v_IF_P @ R_PW, load, dt, self._tuning)

    def legs(
        self, context: Context, w_WP_P: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Computes position and velocity of both soles from joints and gyroscope."""
        scratch, state = self._scratch.Eval(context), self._measured.Eval(context)
        # With the pelvis at W's origin, quantities in W are quantities in P.
        pelvis = self._pelvis
        state[pelvis.orientation], state[pelvis.position] = (1.0, 0.0, 0.0, 0.0), 0.0
        state[pelvis.angular_velocity] = w_WP_P
        state[pelvis.velocity] = -cross(w_WP_P, self._p_PI)
        self._plant.SetPositionsAndVelocities(scratch, state)
        positions = [s.CalcPoseInWorld(scratch).translation() for s in self._soles]
        velocities = [
            s.CalcSpatialVelocityInWorld(scratch).translational() for s in self._soles
        ]
        return np.array(positions) - self._p_PI, np.array(velocities)

    def _estimate(self, context: Context) -> np.ndarray:
        odometry: OdometryState = self._odometry.Eval(context)
        R_WP = rotation_matrix(odometry.q_WP)
        p_PI_W, w_WP = R_WP @ self._p_PI, R_WP @ self._inertial.Eval(context)[:3]
        state = self._measured.Eval(context)
        pelvis = self._pelvis
        state[pelvis.orientation] = odometry.q_WP
        state[pelvis.position] = odometry.p_WI - p_PI_W
        state[pelvis.angular_velocity] = w_WP
        state[pelvis.velocity] = odometry.v_WI - cross(w_WP, p_PI_W)
        return state
