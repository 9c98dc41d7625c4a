"""Level ground and the boxes of a terrain, in a plant."""

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
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.worlds.terrain import GROUND_SIZE, GROUND_THICKNESS, Block

GROUND = "ground"
"""Name of the level ground's geometry."""


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
    X_WG = RigidTransform([0.0, 0.0, -0.5 * GROUND_THICKNESS])
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
        material = _material(friction)
        scene_graph.AssignRole(
            context, plant.get_source_id(), geometry, material, RoleAssign.kReplace
        )
