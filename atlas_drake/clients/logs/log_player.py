"""The ports of a station that displays read, fed from a log.

``film.replay`` connects the ports to displays.
"""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.clients.logs.log import Log
from atlas_drake.frozen import replace
from atlas_drake.records import TickRecord
from atlas_drake.robot.robot import coordinates_beside, own_places
from atlas_drake.simulation.sockets import CollectableSystem


class LogPlayer(CollectableSystem):
    """Outputs the log's record at the Context's time; beyond its ends the nearest one.

    Output ports:
        record: ``TickRecord`` of the tick before, with the planned paths that were
            logged last.
        plant_state: State of robot and world.
    """

    __slots__ = ()

    def __init__(self, log: Log, plant: MultibodyPlant):
        """Plays ``log``, with the display's plant of robot and world."""
        super().__init__()
        self._log = log
        self._default = plant.GetPositionsAndVelocities(plant.CreateDefaultContext())
        self._own = np.concatenate(own_places(plant, log.robot))
        # Coordinates that the log does not hold keep their default values.
        self._beside = [
            (place, log.numbers[f"world.{column}.{label}"])
            for column, places in coordinates_beside(plant, log.robot).items()
            for label, place in places.items()
            if f"world.{column}.{label}" in log.numbers
        ]
        time, size = {self.time_ticket()}, len(self._default)
        self.declare_value_output("record", self._record, time)
        self.declare_vector_output("plant_state", size, self._plant_state, time)

    def _record(self, context: Context) -> TickRecord:
        # As in a run, a picture at a tick shows the record of the tick before.
        row = self._log.row_at(context.get_time() - 2e-9)
        return replace(self._log.record(row), paths=self._log.paths_at(row))

    def _plant_state(self, context: Context) -> np.ndarray:
        log, row = self._log, self._log.row_at(context.get_time())
        state = self._default.copy()
        state[self._own] = np.concatenate([log["state.q"][row], log["state.v"][row]])
        for place, numbers in self._beside:
            state[place] = numbers[row]
        return state
