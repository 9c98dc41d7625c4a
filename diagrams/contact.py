"""Ground, terrain and the contact of shapes: friction and dissipation.

Point contact has one contact point, which jumps between the corners of a box at rest.
With Drake's default dissipation a box of 3 kg sinks 30 mm/s into its table at steps of
3 ms. Shapes that give their own dissipation keep it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    ProximityProperties,
    Role,
    RoleAssign,
    SceneGraph,
    SceneGraphConfig,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot
from atlas_drake.worlds.terrain import GROUND_SIZE, GROUND_THICKNESS, Block

GROUND = "ground"
"""Name of the level ground's geometry."""
RESTING = 5.0
"""Dissipation of a shape without one of its own [s/m]: boxes of 0.3 to 40 kg sink by
1 mm at most, and nothing rebounds faster than at 0.2 m/s."""
_PROPERTY = ("material", "hunt_crossley_dissipation")


def block_name(index: int) -> str:
    """Return the name of a terrain block's geometry."""
    return f"terrain_{index}"


def add_scenery(
    plant: MultibodyPlant, terrain: Iterable[Block], ground_friction: float
) -> None:
    """Adds the level ground and the terrain's boxes to a plant (before Finalize).

    ``ground_friction`` [-] is that of the ground, and of boxes without their own.
    """
    # A half-space would end the process: FCL's tree of fixed shapes, which has no limit
    # to their number otherwise, cannot balance itself with a shape of infinite size.
    ground = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
    X_WG = RigidTransform(np.array([0.0, 0.0, -0.5 * GROUND_THICKNESS]))
    world = plant.world_body()
    plant.RegisterCollisionGeometry(
        world, X_WG, ground, GROUND, _material(ground_friction)
    )
    for number, block in enumerate(terrain):
        X_WC, shape, name = block.X_WC, Box(np.array(block.size)), block_name(number)
        friction = ground_friction if block.friction is None else block.friction
        plant.RegisterCollisionGeometry(world, X_WC, shape, name, _material(friction))
        plant.RegisterVisualGeometry(world, X_WC, shape, name, block.rgba)


def _material(friction: float) -> ProximityProperties:
    """Returns a rigid material; its surface counts where contact is hydroelastic."""
    properties = ProximityProperties()
    AddContactMaterial(
        friction=CoulombFriction(friction, friction), properties=properties
    )
    AddRigidHydroelasticProperties(properties)
    return properties


def set_ground_friction(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    context: Context,
    terrain: Sequence[Block],
    friction: float,
) -> None:
    """Give ground and terrain another coefficient of friction [-].

    Blocks with a coefficient of their own keep it. ``context`` is the scene graph's.
    """
    names = [block_name(i) for i, b in enumerate(terrain) if b.friction is None]
    inspector = scene_graph.model_inspector()
    for name in (GROUND, *names):
        geometry = inspector.GetGeometryIdByName(
            inspector.world_frame_id(), Role.kProximity, name
        )
        properties = ProximityProperties(inspector.GetProximityProperties(geometry))
        properties.UpdateProperty(
            "material", "coulomb_friction", CoulombFriction(friction, friction)
        )
        scene_graph.AssignRole(
            context, plant.get_source_id(), geometry, properties, RoleAssign.kReplace
        )


def scene_graph_config() -> SceneGraphConfig:
    """Returns Drake's configuration with the dissipation at which things rest."""
    config = SceneGraphConfig()
    config.default_proximity_properties.hunt_crossley_dissipation = RESTING
    return config


def set_robot_dissipation(
    plant: MultibodyPlant, scene_graph: SceneGraph, robot: Robot
) -> None:
    """Gives the robot's shapes Drake's default in contact with anything else.

    Of two shapes of equal stiffness the mean of their dissipations counts. Called
    before Finalize.
    """
    drakes = SceneGraphConfig().default_proximity_properties.hunt_crossley_dissipation
    inspector = scene_graph.model_inspector()
    for index in plant.GetBodyIndices(robot.instance(plant)):
        frame = plant.GetBodyFrameIdOrThrow(index)
        for shape in inspector.GetGeometries(frame, Role.kProximity):
            properties = ProximityProperties(inspector.GetProximityProperties(shape))
            if not properties.HasProperty(*_PROPERTY):
                properties.AddProperty(*_PROPERTY, 2.0 * drakes - RESTING)
                scene_graph.AssignRole(
                    plant.get_source_id(), shape, properties, RoleAssign.kReplace
                )
