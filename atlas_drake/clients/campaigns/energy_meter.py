"""The work of the motors in a run."""

import numpy as np
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.simulation.sockets import CollectableSystem


class EnergyMeter(CollectableSystem):
    """Efforts and state in, work so far out.

    Input ports:
        effort: Efforts of the motors [N·m], shape (n,).
        state: Positions and velocities of the robot.

    Output ports:
        work: Work done by the motors, and work done on them; both positive [J],
            shape (2,).
    """

    __slots__ = ()

    def __init__(self, velocities: np.ndarray, num_states: int, period: float) -> None:
        """Adds up every ``period`` [s].

        ``velocities`` are the indices of the joints' velocities in the state, in the
        order of the efforts.
        """
        super().__init__()
        self._velocities, self._period = velocities, period
        self._effort = self.DeclareVectorInputPort("effort", len(velocities))
        self._state = self.DeclareVectorInputPort("state", num_states)
        self._work = self.DeclareDiscreteState(2)
        self.DeclareStateOutputPort("work", self._work)
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._update)

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        velocity = self._state.Eval(context)[self._velocities]
        power = self._effort.Eval(context) * velocity
        done = float(power[power > 0.0].sum())
        taken = float(-power[power < 0.0].sum())
        work = context.get_discrete_state(self._work).value()
        discrete.set_value(self._work, work + self._period * np.array([done, taken]))
