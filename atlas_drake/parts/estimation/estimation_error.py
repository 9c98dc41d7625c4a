"""The error of the estimated state, and its largest value of a run."""

import math

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.control.attitude import turn_between
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_matrix
from atlas_drake.systems.collectable_system import CollectableSystem


class EstimationError(CollectableSystem):
    """True and estimated state in, their difference out.

    Input ports:
        state: True positions and velocities of the robot.
        estimated_state: Estimated positions and velocities of the robot.

    Output ports:
        estimation_error: Error of the pelvis, estimated minus true: position [m],
            velocity [m/s] and rotation from the true to the estimated orientation
            [rad], each in W; shape (9,).
        largest_estimation_error: Largest errors of the run so far: distance [m], speed
            [m/s], tilt [rad] and yaw [rad], shape (4,).
    """

    __slots__ = ()

    def __init__(self, robot: Robot, plant: MultibodyPlant, period: float):
        """Updates the largest errors every ``period`` [s]."""
        super().__init__()
        self._pelvis = robot.indices(plant).pelvis
        size = plant.num_multibody_states(robot.instance(plant))
        self._true = self.DeclareVectorInputPort("state", size)
        self._estimated = self.DeclareVectorInputPort("estimated_state", size)
        self._largest = self.DeclareDiscreteState(4)
        self._error = self.declare_vector_output("estimation_error", 9, self._present)
        self.DeclareStateOutputPort("largest_estimation_error", self._largest)
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._update)

    def _present(self, context: Context) -> np.ndarray:
        true, estimated = self._true.Eval(context), self._estimated.Eval(context)
        pelvis, difference = self._pelvis, estimated - true
        q_WP = true[pelvis.orientation]
        turn_P = turn_between(q_WP, estimated[pelvis.orientation])
        turn_W = rotation_matrix(q_WP) @ turn_P
        parts = difference[pelvis.position], difference[pelvis.velocity], turn_W
        return np.concatenate(parts)

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        largest = context.get_discrete_state(self._largest).value()
        now = error_sizes(self._error.Eval(context))
        discrete.set_value(self._largest, np.maximum(largest, now))


def error_sizes(error: np.ndarray) -> np.ndarray:
    """Computes distance [m], speed [m/s], tilt and yaw [rad] of an error, (4,)."""
    x, y, z, vx, vy, vz, roll, pitch, yaw = error.tolist()
    distance = math.sqrt(x * x + y * y + z * z)
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    return np.array([distance, speed, math.hypot(roll, pitch), abs(yaw)])
