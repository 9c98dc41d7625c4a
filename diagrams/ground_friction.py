"""The friction of the ground in a Context, so that each run can have its own."""

from collections.abc import Sequence

from pydrake.geometry import ProximityProperties, Role, RoleAssign, SceneGraph
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.scenario.terrain import Block

GROUND = "ground"
"""Name of the level ground's geometry."""


def block_name(index: int) -> str:
    """Return the name of a terrain block's geometry."""
    return f"terrain_{index}"


def set_ground_friction(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    context: Context,
    terrain: Sequence[Block],
    friction: float,
) -> None:
    """Give the ground another coefficient of friction.

    Args:
        plant: Plant with ground and terrain.
        scene_graph: Scene graph of the plant.
        context: Context of the scene graph.
        terrain: Blocks on the ground; those with a coefficient of their own keep it.
        friction: Coefficient [-].
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
