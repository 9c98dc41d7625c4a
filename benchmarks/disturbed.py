"""A robot for which nothing is quite as its controller believes.

The random changes that the project's goals speak of, shared by the benchmarks; what
a robot is then asked to do is in each of them.
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
"""Half width of each link's mass, as a share of what the controller believes [-]."""
FRICTION = (0.6, 1.0)
"""Coefficients of the ground."""
NOISE = "reference"
"""Name of the sensors' noise model."""


@dataclass(frozen=True)
class Physics:
    """How the physics is solved; the defaults are those of a scenario.

    Attributes:
        contact: Drake's name of how contact is solved.
        step: Of plant and joint controllers [s].
        period: Of the behaviors [s].
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
    """The robot in STAND with everything drawn from ``seed``."""
    # Runs report for themselves.
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
    """The robots that come with the package and need not be fetched first."""
    names = available_robots()
    return [name for name in names if name != "drake_atlas" or models_at_hand()]


def fresh_seed() -> int:
    """A seed that nobody has tuned for."""
    return random.SystemRandom().randrange(10**9)


def falls(sim: AtlasSimulation) -> list[str]:
    """When and how the robot fell, as text; empty if it did not."""
    return [
        f"{event.time:.3f} s: {event.text}"
        for event in sim.events
        if event.kind == "fall"
    ]
