"""``Snapshot``: everything that decides how a run goes on, as a copy of the present.

``AtlasSimulation.snapshot`` makes it, ``AtlasSimulation.restore`` goes back to it.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydrake.systems.framework import Context

from atlas_drake.scenario import Scenario
from atlas_drake.simulation.run_log import RunLog
from atlas_drake.simulation.start import Variation


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The stored state of a run, valid as long as its simulation.

    Attributes:
        context: Copy of the diagram's root context: physics, joint controllers,
            behaviors, commands in force and received, schedule, pushes, noise.
        scenario: The scenario of the run.
        variation: What the run drew from its seed.
        log: Copy of the events until then.
        wall_time: Wall time of the run until then [s].
    """

    context: Context
    scenario: Scenario
    variation: Variation
    log: RunLog
    wall_time: float

    @property
    def time(self) -> float:
        """Simulated time of the snapshot [s]."""
        return float(self.context.get_time())
