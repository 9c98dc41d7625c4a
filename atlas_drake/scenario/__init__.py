"""Scenarios as data: what is simulated, from YAML or Python.

Nothing here simulates.
"""

from atlas_drake.scenario.models import Model
from atlas_drake.scenario.scenario import (
    Jitter,
    Scenario,
    Start,
    load_scenario,
    scenario_from,
    with_settings,
)

__all__ = [
    "Jitter",
    "Model",
    "Scenario",
    "Start",
    "load_scenario",
    "scenario_from",
    "with_settings",
]
