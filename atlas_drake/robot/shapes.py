"""The shapes of a robot without a world: whether its links touch each other."""

from __future__ import annotations

import functools

import numpy as np
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    SceneGraph,
)
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import Context, DiagramBuilder

from atlas_drake.robot.robot import Robot

CLEAR = 0.01
"""Distance that links keep from each other [m]. Two that are nearer in the stand-prep
pose, such as a shoulder and the trunk, are neighbors and may touch."""


@functools.lru_cache(maxsize=8)
def shapes_of(robot: Robot) -> Shapes:
    """Returns the shapes of a robot; cached, as it parses the robot."""
    return Shapes(robot)


class Shapes:
    """A robot alone, with its shapes. Holds no state.

    Attributes:
        plant: The plant of the robot, with the positions of ``robot.plant``.
        scene_graph: Its shapes.
    """

    def __init__(self, robot: Robot):
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        robot.add_to(plant)
        plant.Finalize()
        self.plant: MultibodyPlant = plant
        self.scene_graph: SceneGraph = scene_graph
        self._diagram = builder.Build()
        self._robot = robot

    def context(self) -> Context:
        """Creates a Context of the plant, whose shapes can be asked for distances."""
        root = self._diagram.CreateDefaultContext()
        return self.plant.GetMyMutableContextFromRoot(root)

    def context_for(self, moving: np.ndarray) -> Context:
        """Creates a Context in which the links of some joints are watched alone.

        Two links that these joints do not move, and neighbors, may touch.

        Args:
            moving: Which joints move, bool, shape (n,), message order.
        """
        root = self._diagram.CreateDefaultContext()
        filters = self.scene_graph.collision_filter_manager(
            self.scene_graph.GetMyMutableContextFromRoot(root)
        )
        plant, robot = self.plant, self._robot
        own = {link for i in np.flatnonzero(moving) for link in robot.moved_links[i]}
        bodies = map(plant.get_body, plant.GetBodyIndices(robot.instance(plant)))
        rest = [body for body in bodies if body.name() not in own]
        still = GeometrySet(
            [plant.GetBodyFrameIdOrThrow(body.index()) for body in rest]
        )
        filters.Apply(CollisionFilterDeclaration().ExcludeWithin(still))
        for one, other in self._neighbors:
            pair = GeometrySet(one), GeometrySet(other)
            filters.Apply(CollisionFilterDeclaration().ExcludeBetween(*pair))
        return plant.GetMyMutableContextFromRoot(root)

    def distances(self, context: Context, most: float) -> tuple[np.ndarray, np.ndarray]:
        """Computes how far links are from each other that are near.

        Args:
            context: Of the plant, from ``context`` or ``context_for``.
            most: Largest distance that counts as near [m].

        Returns:
            Distances [m], shape (m,), and their derivatives by time over the plant's
            velocities, shape (m, number of velocities).
        """
        plant, inspector = self.plant, self.scene_graph.model_inspector()
        query = plant.get_geometry_query_input_port().Eval(context)
        near = query.ComputeSignedDistancePairwiseClosestPoints(most)

        def velocity(shape: GeometryId, p_GC: np.ndarray) -> np.ndarray:
            body = plant.GetBodyFromFrameId(inspector.GetFrameId(shape))
            J: np.ndarray = plant.CalcJacobianTranslationalVelocity(
                context,
                JacobianWrtVariable.kV,
                body.body_frame(),
                inspector.GetPoseInFrame(shape) @ p_GC,
                plant.world_frame(),
                plant.world_frame(),
            )
            return J

        J = np.zeros((len(near), plant.num_velocities()))
        for row, pair in zip(J, near, strict=True):
            apart = velocity(pair.id_A, pair.p_ACa) - velocity(pair.id_B, pair.p_BCb)
            row[:] = pair.nhat_BA_W @ apart
        return np.array([pair.distance for pair in near]), J

    @functools.cached_property
    def _neighbors(self) -> list[tuple[GeometryId, GeometryId]]:
        context, robot = self.context(), self._robot
        standing = robot.plant.GetPositions(robot.standing_context())
        self.plant.SetPositions(context, standing)
        query = self.plant.get_geometry_query_input_port().Eval(context)
        near = query.ComputeSignedDistancePairwiseClosestPoints(CLEAR)
        return [(pair.id_A, pair.id_B) for pair in near]
