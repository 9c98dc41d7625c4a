"""A robot that differs randomly from the model of its controller.

The random variations of the project's goals, shared by the benchmarks.
"""

from __future__ import annotations

import logging
import math
import random
from dataclasses import dataclass

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.robot import available_robots, models_at_hand
from atlas_drake.scenario import Jitter
from atlas_drake.scenario.drake_configs import plant_config

POSITION = 0.02
"""Half width of the pelvis' place along x and y [m]."""
ORIENTATION = math.radians(2.0)
"""Half width of the pelvis' attitude [rad]."""
JOINTS = 0.02
"""Half width of each joint's position [rad]."""
MASS = 0.05
"""Half width of each link's mass, as a share of the controller's model [-]."""
FRICTION = (0.6, 1.0)
"""Coefficients of the ground."""
NOISE = "reference"
"""Name of the sensors' noise model."""


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
    programme: str = "none",
    duration: float = 10.0,
    physics: Physics | None = None,
) -> AtlasSimulation:
    """Makes the robot in STAND with all variations drawn from ``seed``."""
    # Each run prints its own result.
    logging.getLogger("atlas_drake").propagate = False
    logging.getLogger("drake").setLevel(logging.ERROR)
    lowest, highest = FRICTION
    physics = physics or Physics()
    return AtlasSimulation(
        Scenario(
            name="disturbed",
            model=model,
            programme=programme,
            duration=duration,
            physics_step=physics.step,
            control_period=physics.period,
            plant=plant_config(discrete_contact_approximation=physics.contact),
            seed=seed,
            noise=NOISE,
            ground_friction=0.5 * (lowest + highest),
            friction_jitter=0.5 * (highest - lowest),
            jitter=Jitter(
                position=POSITION, orientation=ORIENTATION, joints=JOINTS, mass=MASS
            ),
        )
    )


def robots_at_hand() -> list[str]:
    """Names of the package's robots whose files are available offline."""
    names = available_robots()
    return [name for name in names if name != "drake_atlas" or models_at_hand()]


def fresh_seed() -> int:
    """Draws a fresh seed, for which nothing was tuned."""
    return random.SystemRandom().randrange(10**9)


def falls(sim: AtlasSimulation) -> list[str]:
    """Describes time and kind of a fall; empty without a fall."""
    return [
        f"{event.time:.3f} s: {event.text}"
        for event in sim.events
        if event.kind == "fall"
    ]
