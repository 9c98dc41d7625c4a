"""The contact of shapes: surfaces where things lie and are held, points elsewhere.

Things beside the robot are compliant, robot and ground are rigid: whatever touches a
thing touches it with a surface, and soles touch the ground at points, which is faster.
With one contact point, which jumps between the corners of a box at rest, a crate of
10 kg turns by 0.8° a second, and swings about the line between two hands that hold it.
What a shape's file gives counts.
"""

from __future__ import annotations

from pydrake.geometry import (
    AddRigidHydroelasticProperties,
    ProximityProperties,
    Role,
    RoleAssign,
    SceneGraph,
    SceneGraphConfig,
)
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.robot import Robot

RESTING = 5.0
"""Dissipation of a thing's shape [s/m]: boxes of 0.3 to 40 kg sink by 1 mm at most, and
nothing rebounds faster than at 0.2 m/s."""
STIFFNESS = 5e6
"""Hydroelastic modulus of a thing's shape [Pa], that of hard rubber."""
RESOLUTION = 0.03
"""Length of a surface's edges [m], of a hand's capsule for example."""
_COMPLIANCE = ("hydroelastic", "compliance_type")
_DISSIPATION = ("material", "hunt_crossley_dissipation")


def scene_graph_config() -> SceneGraphConfig:
    """Returns Drake's configuration with things that are compliant, and rest."""
    config = SceneGraphConfig()
    defaults = config.default_proximity_properties
    defaults.compliance_type = "compliant"
    defaults.hydroelastic_modulus = STIFFNESS
    defaults.resolution_hint = RESOLUTION
    defaults.hunt_crossley_dissipation = RESTING
    return config


def set_robot_material(
    plant: MultibodyPlant, scene_graph: SceneGraph, robot: Robot
) -> None:
    """Makes the robot's shapes rigid, with Drake's default dissipation in contact.

    Of two shapes of equal stiffness that touch at a point the mean of their
    dissipations counts. Called before Finalize.
    """
    drakes = SceneGraphConfig().default_proximity_properties.hunt_crossley_dissipation
    inspector = scene_graph.model_inspector()
    for index in plant.GetBodyIndices(robot.instance(plant)):
        frame = plant.GetBodyFrameIdOrThrow(index)
        for shape in inspector.GetGeometries(frame, Role.kProximity):
            properties = ProximityProperties(inspector.GetProximityProperties(shape))
            if not properties.HasProperty(*_COMPLIANCE):
                AddRigidHydroelasticProperties(RESOLUTION, properties)
            if not properties.HasProperty(*_DISSIPATION):
                properties.AddProperty(*_DISSIPATION, 2.0 * drakes - RESTING)
            scene_graph.AssignRole(
                plant.get_source_id(), shape, properties, RoleAssign.kReplace
            )
