"""The contact of shapes: dissipation at which things rest.

Point contact has one contact point, which jumps between the corners of a box at rest.
With Drake's default dissipation a box of 3 kg sinks 30 mm/s into its table at steps of
3 ms. Shapes that give their own dissipation keep it.
"""

from __future__ import annotations

from pydrake.geometry import (
    ProximityProperties,
    Role,
    RoleAssign,
    SceneGraph,
    SceneGraphConfig,
)
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.robot import Robot

RESTING = 5.0
"""Dissipation of a shape without one of its own [s/m]: boxes of 0.3 to 40 kg sink by
1 mm at most, and nothing rebounds faster than at 0.2 m/s."""
_PROPERTY = ("material", "hunt_crossley_dissipation")


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
