"""Steps of a run, and Drake's own configurations: defaults and checks.

Drake itself checks the values; fields that the station sets are refused here.
"""

import copy
import math
from fractions import Fraction
from typing import Any

from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    Simulator,
    SimulatorConfig,
)
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from atlas_drake.errors import ScenarioError

NOMINAL_PERIOD = 0.009
"""Control period that is chosen for the user, up to rounding [s]."""
_BITS = 53 - 22
"""Bits of a step with which its first 2**22 multiples are exact: more than an hour of
1 ms steps."""


def nominal_period(physics_step: float) -> float:
    """Returns the multiple of ``physics_step`` nearest to ``NOMINAL_PERIOD`` [s]."""
    return round(max(round(NOMINAL_PERIOD / physics_step), 1) * physics_step, 12)


def is_multiple(control_period: float, physics_step: float) -> bool:
    """Returns True if the period is a whole number of steps, up to rounding, or 0."""
    steps = control_period / physics_step
    return control_period == 0.0 or (
        round(steps) >= 1 and (abs(steps - round(steps)) <= 1e-9 * steps)
    )


def on_common_grid(physics_step: float, control_period: float) -> tuple[float, float]:
    """Returns the nearest pair [s] whose multiples are the same floating-point numbers.

    Drake starts a physics step and a control tick together only if both times are the
    same number. The pair differs from the given one by a relative error below 1e-9; it
    is the given one where the period is an exact multiple of the step.
    """
    ratio = round(control_period / physics_step)
    if Fraction(control_period) == ratio * Fraction(physics_step):
        return physics_step, control_period
    mantissa, exponent = math.frexp(physics_step)
    step = math.ldexp(round(math.ldexp(mantissa, _BITS)), exponent - _BITS)
    return step, ratio * step


def plant_config(**fields: Any) -> MultibodyPlantConfig:
    """Returns the default, point contact with exact friction cones, with changes."""
    own = {
        "contact_model": "point",
        "discrete_contact_approximation": "similar",
        # Sampled ports would make the plant's step an unrestricted update, which could
        # not read the result of the controller's update at the same instant.
        "use_sampled_output_ports": False,
    }
    return MultibodyPlantConfig(**(own | fields))


def checked_plant_config(
    config: MultibodyPlantConfig, physics_step: float
) -> MultibodyPlantConfig:
    """Returns a checked copy with the station's own fields, such as ``time_step``."""
    config = copy.deepcopy(config)
    _decide(config, "plant", "time_step", physics_step, "set physics_step instead")
    sampled = "use_sampled_output_ports"
    _decide(config, "plant", sampled, False, "must be false: controllers need it")
    try:
        AddMultibodyPlant(config, DiagramBuilder())
    except (Exception, SystemExit) as error:  # Drake raises both.
        raise ScenarioError("plant", config, f"cannot be used: {error}") from error
    return config


def check_simulator_config(config: SimulatorConfig) -> None:
    """Checks the simulator's configuration."""
    _decide(config, "simulator", "start_time", 0.0, "must be 0: times count from 0")
    try:
        simulator = Simulator(ConstantVectorSource([0.0]))
        ApplySimulatorConfig(config, simulator)
        simulator.Initialize()
    except (Exception, SystemExit) as error:  # Drake raises both.
        raise ScenarioError("simulator", config, f"cannot be used: {error}") from error


def _decide(config: object, path: str, name: str, own: float, problem: str) -> None:
    """Gives a field the station's value; refuses any but this and Drake's default."""
    value = getattr(config, name)
    default = getattr(type(config)(), name)
    # A physics step on the common grid differs from the given one by rounding.
    if value != default and not math.isclose(value, own, rel_tol=1e-9):
        raise ScenarioError.about(f"{path}.{name}", value, problem)
    setattr(config, name, own)
