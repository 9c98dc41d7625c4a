"""Scenarios as data: robot, world and settings of a run, from YAML or Python.

The simulation is in ``simulation``.
"""

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.scenario.policy_use import PolicyUse
from atlas_drake.scenario.reading import (
    load_scenario,
    scenario_from,
    with_settings,
    with_values,
)
from atlas_drake.scenario.scenario import Jitter, Scenario, Start
from atlas_drake.systems.pushes import PlannedPush
from atlas_drake.worlds.models import Model

__all__ = [
    "ControllerConfig",
    "Jitter",
    "Model",
    "PlannedPush",
    "PolicyUse",
    "Scenario",
    "Start",
    "load_scenario",
    "scenario_from",
    "with_settings",
    "with_values",
]
