"""A robot that differs randomly from the model of its controller.

The random changes are those of the campaigns, in `campaigns/disturbed.yaml`; what a
robot is then asked to do is in each benchmark.
"""

from __future__ import annotations

import logging
import random
from dataclasses import dataclass, replace
from pathlib import Path

from atlas_drake import AtlasSimulation, Scenario, load_scenario
from atlas_drake.robot import MODELS_FOLDER
from atlas_drake.scenario.physics import plant_config

CAMPAIGNS = Path(__file__).parent / "campaigns"


@dataclass(frozen=True)
class Physics:
    """Settings of the physics; the defaults are those of a scenario.

    Attributes:
        contact: Drake's name of the contact approximation.
        step: Step of plant and joint controllers [s].
        period: Period of the behaviors [s].
    """

    contact: str = plant_config().discrete_contact_approximation
    step: float = Scenario.physics_step
    period: float = Scenario.control_period


def disturbed_simulation(
    seed: int,
    *,
    model: str = "atlas",
    schedule: str = "none",
    duration: float = 10.0,
    physics: Physics | None = None,
) -> AtlasSimulation:
    """Makes the robot in STAND with all variations drawn from ``seed``."""
    # Each run prints its own result.
    logging.getLogger("atlas_drake").propagate = False
    logging.getLogger("drake").setLevel(logging.ERROR)
    physics = physics or Physics()
    scenario = load_scenario(CAMPAIGNS / "disturbed.yaml")
    plant = plant_config(discrete_contact_approximation=physics.contact)
    scenario = replace(
        scenario,
        model=model,
        seed=seed,
        schedule=schedule,
        duration=duration,
        physics_step=physics.step,
        control_period=physics.period,
        plant=plant,
    )
    return AtlasSimulation(scenario)


def robots_at_hand() -> list[str]:
    """Names of the robots whose files come with the package."""
    return sorted(path.stem for path in MODELS_FOLDER.glob("*.urdf"))


def fresh_seed() -> int:
    """Draws a fresh seed, for which nothing was tuned."""
    return random.SystemRandom().randrange(10**9)
