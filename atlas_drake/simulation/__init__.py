"""The front door for Python: one robot, one diagram, one simulator.

What is simulated is in ``scenario``, the wiring in ``diagrams``.
"""

from atlas_drake.simulation.atlas_simulation import AtlasSimulation, SimulationError

__all__ = ["AtlasSimulation", "SimulationError"]
