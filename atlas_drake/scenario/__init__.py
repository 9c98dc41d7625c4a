"""Scenarios as data: robot, world and settings of a run, from YAML or Python.

The simulation is in ``simulation``.
"""

from atlas_drake.scenario.models import Model
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.scenario.reading import (
    load_scenario,
    scenario_from,
    with_settings,
    with_values,
)
from atlas_drake.scenario.scenario import Jitter, Scenario, Start

__all__ = [
    "Jitter",
    "Model",
    "PlannedPush",
    "Scenario",
    "Start",
    "load_scenario",
    "scenario_from",
    "with_settings",
    "with_values",
]
