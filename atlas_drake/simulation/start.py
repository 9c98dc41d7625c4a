"""How a run begins: its random variation, and the start that a reset asks for.

``standing`` places the soles on the ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.framework import Context

from atlas_drake.config import checked
from atlas_drake.errors import ScenarioError
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.scenario.scenario import starting_behavior


@dataclass(frozen=True)
class Variation:
    """Initial pose, and one draw of all values that a scenario varies.

    Attributes:
        position: Position of the pelvis, horizontal in W [m], shape (2,).
        rpy: Roll, pitch and yaw of the pelvis [rad], shape (3,).
        joints: Joint positions [rad], shape (n,).
        mass_factor: Factor of the mass of each body, by name [-].
        ground_friction: Coefficient of friction of the ground [-].
    """

    position: np.ndarray
    rpy: np.ndarray
    joints: np.ndarray
    mass_factor: dict[str, float]
    ground_friction: float


def draw_variation(scenario: Scenario, robot: Robot) -> Variation:
    """Draws a variation from the scenario's seed."""
    random = np.random.default_rng(scenario.seed)
    jitter = scenario.jitter
    position = random.uniform(-jitter.position, jitter.position, size=2)
    rpy = random.uniform(-jitter.orientation, jitter.orientation, size=3)
    joints = robot.stand_prep + random.uniform(
        -jitter.joints, jitter.joints, size=robot.num_joints
    )
    friction = scenario.ground_friction + random.uniform(
        -scenario.friction_jitter, scenario.friction_jitter
    )
    start, yaw = scenario.start_pose()
    return Variation(
        position=np.array(start) + position,
        rpy=rpy + np.array([0.0, 0.0, yaw]),
        joints=np.clip(joints, robot.position_lower, robot.position_upper),
        mass_factor={
            name: 1.0 + random.uniform(-jitter.mass, jitter.mass)
            for name in robot.body_names
        },
        ground_friction=friction,
    )


def scale_masses(
    plant: MultibodyPlant, context: Context, robot: Robot, variation: Variation
) -> None:
    """Scales the default masses of the robot in a context of the plant.

    The controller's model keeps its masses.
    """
    for name, factor in variation.mass_factor.items():
        if factor == 1.0:
            continue
        body = plant.GetBodyByName(name, robot.instance(plant))
        inertia = body.default_spatial_inertia()
        body.SetSpatialInertiaInBodyFrame(
            context,
            SpatialInertia(
                inertia.get_mass() * factor,
                inertia.get_com(),
                inertia.get_unit_inertia(),
            ),
        )


def start_of_reset(
    scenario: Scenario,
    catalog: BehaviorCatalog,
    behavior: Behavior | int | str | None,
    pose: Start | None,
) -> tuple[Behavior, Start]:
    """Returns behavior and start of a reset; None is the scenario's."""
    asked = scenario.initial_behavior if behavior is None else behavior
    begin = starting_behavior(asked, "behavior", catalog)
    start: Start = checked(Start, scenario.start if pose is None else pose, "pose")
    start.check_behavior(begin)
    if start.on_gantry and not scenario.start.on_gantry:
        raise ScenarioError(
            "start.on_gantry", True, "needs a scenario that began on the gantry"
        )
    return begin, start
