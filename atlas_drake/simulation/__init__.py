"""The simulation for Python programs: one robot, one diagram, one simulator.

Scenarios are in ``scenario``, the connections of the systems in ``diagrams``.
"""

from atlas_drake.simulation.atlas_simulation import AtlasSimulation, SimulationError

__all__ = ["AtlasSimulation", "SimulationError"]
