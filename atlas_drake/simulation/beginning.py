"""How a run begins: what it draws from its seed, and where robot and world are put.

``standing`` places the soles on the ground.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.diagrams.standing import place_robot
from atlas_drake.frozen import replace
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario, Start
from atlas_drake.worlds.models import ModelDraw, begin_models, scale_mass
from atlas_drake.worlds.scenery import set_ground_friction
from atlas_drake.worlds.world import put_world_back

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

CLEARANCE = 0.10
"""Height of the feet above the ground on the gantry [m]."""
Pose: TypeAlias = tuple[Sequence[float], float]
"""Position of the pelvis, horizontal in W [m], and its yaw [rad]."""


@dataclass(frozen=True)
class Variation:
    """Initial pose, and one draw of all values that a scenario varies.

    Attributes:
        position: Position of the pelvis, horizontal in W [m], shape (2,).
        rpy: Roll, pitch and yaw of the pelvis [rad], shape (3,).
        joints: Joint positions [rad], shape (n,).
        mass_factor: Factor of the mass of each body, by name [-].
        ground_friction: Coefficient of friction of the ground [-].
        models: What varies of the models of the world, in their order.
    """

    position: np.ndarray
    rpy: np.ndarray
    joints: np.ndarray
    mass_factor: dict[str, float]
    ground_friction: float
    models: tuple[ModelDraw, ...]


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
        models=tuple(model.draw(random) for model in scenario.all_models()),
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
        scale_mass(plant.GetBodyByName(name, robot.instance(plant)), context, factor)


def moved(variation: Variation, pose: Pose | None) -> Variation:
    """Returns what a run drew, at another place; None is its own."""
    if pose is None:
        return variation
    position, yaw = pose
    return replace(
        variation,
        position=np.array(position, dtype=float),
        rpy=np.array([0.0, 0.0, yaw]),
    )


def begin(sim: AtlasSimulation, scenario: Scenario, variation: Variation) -> None:
    """Sets the context to time 0 of a run: masses, friction, noise, robot and world."""
    context = sim.context
    sim.diagram.SetDefaultContext(context)
    context.SetTime(0.0)
    plant, of_plant = sim.part("plant")
    scale_masses(plant, of_plant, sim.robot, variation)
    for name in ("robot_sensors", "inertial_sensor", "motors"):
        if sim.station.HasSubsystemNamed(name):
            noisy, of_noisy = sim.part(name)
            noisy.set_seed(of_noisy, scenario.seed)
    scene_graph, of_scene = sim.part("scene_graph")
    terrain, friction = scenario.all_terrain(), variation.ground_friction
    set_ground_friction(plant, scene_graph, of_scene, terrain, friction)
    place(sim, context, scenario, variation, scenario.start)
    hold(sim, scenario.start)


def put_back(sim: AtlasSimulation, variation: Variation, start: Start) -> None:
    """Puts robot and world back; time goes on."""
    place(sim, sim.context, sim.scenario, variation, start)
    hold(sim, start)


def place(
    sim: AtlasSimulation,
    root: Context,
    scenario: Scenario,
    variation: Variation,
    start: Start,
) -> None:
    """Puts robot and world where they begin, in a context of the diagram."""
    context = sim.plant.GetMyMutableContextFromRoot(root)
    put_world_back(sim.plant, context, sim.robot)
    begin_models(scenario.all_models(), variation.models, sim.plant, context)
    place_robot(
        sim.plant,
        context,
        sim.robot,
        position=variation.position,
        rpy=variation.rpy,
        joints=variation.joints,
        terrain=scenario.all_terrain(),
        clearance=CLEARANCE if start.on_gantry else 0.0,
    )


def hold(sim: AtlasSimulation, start: Start) -> None:
    """Hangs the robot on the gantry where it is, if there is one and it begins so."""
    if not sim.station.HasSubsystemNamed("gantry"):
        return
    gantry, context = sim.part("gantry")
    if not start.on_gantry:
        gantry.let_go(context)
        return
    X_WP = sim.pelvis_pose
    released = None
    if start.release_time is not None:
        released = sim.time + start.release_time
    p_WP, R_WP = X_WP.translation(), X_WP.rotation().matrix()
    gantry.hold(context, p_WP, R_WP, CLEARANCE, released)
