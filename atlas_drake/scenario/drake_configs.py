"""Drake's own configurations in a scenario: defaults and checks.

Drake itself checks the values; fields that the station sets are refused here.
"""

import copy
import math
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


def plant_config(**fields: Any) -> MultibodyPlantConfig:
    """Returns the default: point contact, and friction that never exceeds its cone.

    Args:
        **fields: Fields of ``MultibodyPlantConfig`` with other values.
    """
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
    """Returns the plant's configuration with the fields that the station decides.

    The given one stays as it is: its scenario may get another physics step yet.

    Args:
        config: Configuration; in the result ``time_step`` is the physics step. Drake's
            defaults of the other fields that the station decides are replaced too.
        physics_step: Step of plant and joint controllers [s].

    Raises:
        ScenarioError: Naming the field that cannot be used.
    """
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
    """Checks the simulator's configuration.

    Raises:
        ScenarioError: Naming the field that cannot be used.
    """
    _decide(config, "simulator", "start_time", 0.0, "must be 0: times count from 0")
    try:
        simulator = Simulator(ConstantVectorSource([0.0]))
        ApplySimulatorConfig(config, simulator)
        simulator.Initialize()
    except (Exception, SystemExit) as error:  # Drake raises both.
        raise ScenarioError("simulator", config, f"cannot be used: {error}") from error


def _decide(config: object, path: str, name: str, own: float, problem: str) -> None:
    """Gives a field the station's own value.

    Raises:
        ScenarioError: If the field has a value that is neither the station's nor
            Drake's default.
    """
    value = getattr(config, name)
    default = getattr(type(config)(), name)
    # A physics step on the common grid differs from the given one by rounding.
    if value != default and not math.isclose(value, own, rel_tol=1e-9):
        raise ScenarioError.about(f"{path}.{name}", value, problem)
    setattr(config, name, own)
