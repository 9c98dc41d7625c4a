"""Numbers for reports, kept in the Context while a run goes on.

Peaks and the motors' work; no controller reads them.
"""

import math

import numpy as np
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.robot import PlantIndices, Robot
from atlas_drake.systems.collectable_system import CollectableSystem


class RunStatistics(CollectableSystem):
    """State and efforts in, their peaks so far out.

    Input ports:
        state: Positions and velocities of the robot.
        effort: Efforts of the motors [N·m], shape (n,), message order.

    Output ports:
        peaks: Peak effort of each joint as a share of its limit, then the lowest
            height [m] and the largest tilt [rad] of the pelvis, shape (n + 2,).
    """

    __slots__ = ()

    def __init__(
        self, robot: Robot, indices: PlantIndices, num_states: int, period: float
    ):
        """Updates the peaks every ``period`` [s]."""
        super().__init__()
        n = robot.num_joints
        self._pelvis = indices.pelvis
        self._per_limit = 1.0 / robot.effort_limit
        self._state = self.DeclareVectorInputPort("state", num_states)
        self._effort = self.DeclareVectorInputPort("effort", n)
        start = np.concatenate([np.zeros(n), [np.inf, 0.0]])
        self._peaks = self.DeclareDiscreteState(start)
        self.declare_vector_output("peaks", n + 2, self._per_limits, {self.xd_ticket()})
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._update)

    def _per_limits(self, context: Context) -> np.ndarray:
        peaks = context.get_discrete_state(self._peaks).value().copy()
        peaks[:-2] *= self._per_limit
        return peaks

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        state = self._state.Eval(context)
        _, qx, qy, _ = state[self._pelvis.orientation].tolist()
        height = float(state[self._pelvis.position.stop - 1])
        tilt = math.acos(min(max(1.0 - 2.0 * (qx * qx + qy * qy), -1.0), 1.0))
        after = context.get_discrete_state(self._peaks).value().copy()
        peaks = after[:-2]
        np.maximum(peaks, np.abs(self._effort.Eval(context)), out=peaks)
        after[-2] = min(after[-2], height)
        after[-1] = max(after[-1], tilt)
        discrete.set_value(self._peaks, after)
