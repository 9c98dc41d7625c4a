"""Soles that touch as surfaces: a grid of balls in place of the shapes of each foot.

A box or the hull of a mesh touches in one point, which jumps from step to step, and
four corners let a brick pass between them. Four balls at the corners carry the foot on
level ground; the others are a little higher, so that they cost nothing there.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    ProximityProperties,
    Role,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from atlas_drake.robot.file import RobotFile, SoleSize

RADIUS = 0.08
"""Radius of the balls, in widths of the sole [-]."""
SPACING = 0.05
"""Largest distance between neighboring balls along and across the sole [m]: less than
the smaller side of a brick."""
CORNERS = 4
"""Number of balls at the corners of a sole."""
RECESS = 0.001
"""Height of the other balls above those at the corners [m]."""
FRICTION = CoulombFriction(0.9, 0.9)
"""Friction of a sole whose foot has no shapes [-]."""
_SURFACE = "hydroelastic"
"""Group of the properties of a shape with a surface."""


def add_soles(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    instance: ModelInstanceIndex,
    file: RobotFile,
) -> None:
    """Replaces the collision shapes of both feet by soles (before Finalize).

    A sole has the material of a shape that it replaces, and touches no shape of the
    robot that the replaced one did not touch. A foot whose shapes are hydroelastic
    surfaces already keeps them.

    ``plant.GetCollisionGeometriesForBody`` still lists the replaced shapes; the scene
    graph's inspector has the present ones.
    """
    inspector = scene_graph.model_inspector()
    frames = map(plant.GetBodyFrameIdOrThrow, plant.GetBodyIndices(instance))
    own = [
        shape
        for frame in frames
        for shape in inspector.GetGeometries(frame, Role.kProximity)
    ]
    filters = CollisionFilterDeclaration()
    between: list[GeometryId] = []
    for foot in file.feet:
        frame = plant.GetFrameByName(foot.sole_frame, instance)
        body = frame.body()
        parts = {
            plant.GetBodyFrameIdOrThrow(part.index())
            for part in plant.GetBodiesWeldedTo(body)
        }
        replaced = [shape for shape in own if inspector.GetFrameId(shape) in parts]
        # Copies: what the inspector returns goes with the shape's role.
        materials = [
            ProximityProperties(inspector.GetProximityProperties(shape))
            for shape in replaced
        ]
        if any(material.HasGroup(_SURFACE) for material in materials):
            continue
        others = [shape for shape in own if shape not in replaced]
        passed = [
            shape
            for shape in others
            if any(inspector.CollisionFiltered(old, shape) for old in replaced)
        ]
        for shape in replaced:
            scene_graph.RemoveRole(plant.get_source_id(), shape, Role.kProximity)
        X_BF = frame.GetFixedPoseInBodyFrame()
        balls = [
            plant.RegisterCollisionGeometry(
                body,
                X_BF @ RigidTransform(p_FS),
                Sphere(RADIUS * file.sole.width),
                f"{foot.sole_frame}_{number}",
                materials[0] if materials else _default_material(),
            )
            for number, p_FS in enumerate(ball_centers(file.sole))
        ]
        own, between = [*others, *balls[:CORNERS]], [*between, *balls[CORNERS:]]
        filters.ExcludeBetween(GeometrySet(balls), GeometrySet(passed))
    # Of a sole only the corners touch the robot itself.
    filters.ExcludeBetween(GeometrySet(between), GeometrySet(own))
    filters.ExcludeWithin(GeometrySet(between))
    scene_graph.collision_filter_manager().Apply(filters)


def _default_material() -> ProximityProperties:
    properties = ProximityProperties()
    AddContactMaterial(properties=properties, friction=FRICTION)
    return properties


def ball_centers(sole: SoleSize) -> list[np.ndarray]:
    """Returns the centers of a sole's balls in the sole frame [m], each of shape (3,).

    Those at the corners come first, and touch the sole's plane from above.
    """
    x, y, radius = 0.5 * sole.length, 0.5 * sole.width, RADIUS * sole.width
    corners = list(itertools.product((x, -x), (y, -y)))
    grid = itertools.product(*map(_spread, (sole.length, sole.width)))
    others = [place for place in grid if place not in corners]
    return [
        *(np.array([*place, radius]) for place in corners),
        *(np.array([*place, radius + RECESS]) for place in others),
    ]


def _spread(size: float) -> list[float]:
    """Returns places from end to end of a sole, at most ``SPACING`` apart [m]."""
    places: list[float] = np.linspace(
        -0.5 * size, 0.5 * size, 1 + math.ceil(size / SPACING)
    ).tolist()
    return places


def sole_corners(
    p_WF: np.ndarray, R_WF: np.ndarray, half_length: float, half_width: float
) -> np.ndarray:
    """Computes the corners of a rectangle about a sole's center in W [m], (4, 3)."""
    corners = np.array(
        [
            [half_length, half_width, 0.0],
            [half_length, -half_width, 0.0],
            [-half_length, -half_width, 0.0],
            [-half_length, half_width, 0.0],
        ]
    )
    return p_WF + corners @ R_WF.T
