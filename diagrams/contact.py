"""The contact of shapes: surfaces where things lie and are held, points elsewhere.

Things beside the robot are compliant, robot and ground are rigid: whatever touches a
thing touches it with a surface. Soles touch everything at points: with surfaces a walk
over a plate takes three times as long, and lands no better.
With one contact point, which jumps between the corners of a box at rest, a crate of
10 kg turns by 0.8° a second, and swings about the line between two hands that hold it.
What a shape's file gives counts.
"""

from __future__ import annotations

from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddRigidHydroelasticProperties,
    HalfSpace,
    ProximityProperties,
    Role,
    RoleAssign,
    SceneGraph,
    SceneGraphConfig,
)
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

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
    """Returns Drake's configuration with the dissipation at which things rest."""
    config = SceneGraphConfig()
    config.default_proximity_properties.hunt_crossley_dissipation = RESTING
    return config


def set_materials(plant: MultibodyPlant, scene_graph: SceneGraph, robot: Robot) -> None:
    """Makes things compliant and the robot rigid, but for its feet.

    The robot's shapes have Drake's default dissipation in contact: of two shapes of
    equal stiffness that touch at a point the mean of their dissipations counts. Called
    before Finalize.
    """
    drakes = SceneGraphConfig().default_proximity_properties.hunt_crossley_dissipation
    inspector, own = scene_graph.model_inspector(), robot.instance(plant)
    feet = {foot.body for foot in robot.file.feet}
    for index in map(BodyIndex, range(1, plant.num_bodies())):
        body, frame = plant.get_body(index), plant.GetBodyFrameIdOrThrow(index)
        is_own = body.model_instance() == own
        for shape in inspector.GetGeometries(frame, Role.kProximity):
            properties = ProximityProperties(inspector.GetProximityProperties(shape))
            has_surface = properties.HasProperty(*_COMPLIANCE)
            if is_own and not properties.HasProperty(*_DISSIPATION):
                properties.AddProperty(*_DISSIPATION, 2.0 * drakes - RESTING)
            if is_own and not has_surface and body.name() not in feet:
                AddRigidHydroelasticProperties(RESOLUTION, properties)
            # An infinite shape is the ground of somebody's own world.
            endless = isinstance(inspector.GetShape(shape), HalfSpace)
            if not (is_own or has_surface or endless):
                AddCompliantHydroelasticProperties(RESOLUTION, STIFFNESS, properties)
            scene_graph.AssignRole(
                plant.get_source_id(), shape, properties, RoleAssign.kReplace
            )
