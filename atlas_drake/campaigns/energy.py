"""Puts a meter of the motors' work into a diagram, for the metric ``energy``."""

from __future__ import annotations

from typing import Any

from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.robot import Robot
from atlas_drake.systems.energy_meter import EnergyMeter

STEPS = 2
"""Physics steps between two looks at the motors' power."""
PORT = "motor_work"
"""Output port of the diagram with the work."""


def add_energy_meter(builder: DiagramBuilder, station: Diagram, robot: Robot) -> None:
    """Adds the meter and exports its output.

    Args:
        builder: Of the diagram around the station.
        station: An AtlasStation.
        robot: In the station.
    """
    plant: Any = station.GetSubsystemByName("plant")
    own = robot.instance(plant)
    velocities = plant.num_positions(own) + robot.indices(plant).v
    num_states = plant.num_multibody_states(own)
    meter = builder.AddNamedSystem(
        "energy_meter", EnergyMeter(velocities, num_states, STEPS * plant.time_step())
    )
    for name in ("effort", "state"):
        builder.Connect(station.GetOutputPort(name), meter.GetInputPort(name))
    builder.ExportOutput(meter.GetOutputPort("work"), PORT)
