"""Steps of a run, and Drake's own configurations: defaults and checks."""

import copy
import math
from fractions import Fraction
from typing import Any

from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import GetIntegrationSchemes, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.errors import ScenarioError

NOMINAL_PERIOD = 0.009
"""Control period that is chosen for the user, up to rounding [s]."""
INTEGRATION_SCHEMES = sorted({*GetIntegrationSchemes()} - {"cenic"})
"""Integrators for a run. Drake's cenic finds no plant at the top of the diagram."""
_BITS = 53 - 22
"""Bits of a step with which its first 2**22 multiples are exact: more than an hour of
1 ms steps."""


def nominal_period(physics_step: float) -> float:
    """Returns the multiple of ``physics_step`` nearest to ``NOMINAL_PERIOD`` [s]."""
    return round(max(round(NOMINAL_PERIOD / physics_step), 1) * physics_step, 12)


def is_multiple(time: float, physics_step: float) -> bool:
    """Returns True if the time is a whole number of steps, up to rounding, or 0."""
    steps = time / physics_step
    return time == 0.0 or (
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
    """Returns the default with changes.

    The default has exact friction cones, and surfaces in contact with whatever is
    compliant: things beside the robot, see ``diagrams.contact``.
    """
    own = {
        "contact_model": "hydroelastic_with_fallback",
        "discrete_contact_approximation": "similar",
        # Sampled ports would make the plant's step an unrestricted update, which could
        # not read the result of the controller's update at the same instant.
        "use_sampled_output_ports": False,
    }
    return MultibodyPlantConfig(**(own | fields))


def check_plant_config(config: MultibodyPlantConfig, physics_step: float) -> None:
    """Checks the plant's configuration by making a plant: Drake knows the values."""
    step = config.time_step
    # A physics step on the common grid differs from the given one by rounding.
    if step != MultibodyPlantConfig().time_step and not math.isclose(
        step, physics_step, rel_tol=1e-9
    ):
        problem = "set physics_step instead"
        raise ScenarioError.about("plant.time_step", step, problem)
    try:
        AddMultibodyPlant(config, DiagramBuilder())
    except (Exception, SystemExit) as error:  # Drake raises both.
        raise ScenarioError("plant", config, f"cannot be used: {error}") from error


def stations_plant_config(
    config: MultibodyPlantConfig, physics_step: float
) -> MultibodyPlantConfig:
    """Returns a copy with the fields that the station decides."""
    config = copy.deepcopy(config)
    config.time_step = physics_step
    config.use_sampled_output_ports = False
    return config


def check_simulator_config(config: SimulatorConfig) -> None:
    """Checks the simulator's configuration."""

    def refuse(name: str, problem: str) -> None:
        path = f"simulator.{name}"
        raise ScenarioError.about(path, getattr(config, name), problem)

    if config.start_time != 0.0:
        refuse("start_time", "must be 0: times count from 0")
    if not config.max_step_size >= 0.0:  # NaN, too.
        refuse("max_step_size", "must not be negative")
    if config.integration_scheme not in INTEGRATION_SCHEMES:
        refuse("integration_scheme", f"must be one of {', '.join(INTEGRATION_SCHEMES)}")
