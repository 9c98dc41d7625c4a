"""Models beside the robot: adding them to a plant, and resetting their state.

A world is a sequence of callables (plant) -> None. Each may add models to a plant that
holds the robot and the ground, and is not finalized yet. The callables run for every
plant that simulates or films the world, and so must add the same models each time.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from typing import NamedTuple, TypeAlias

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from atlas_drake.errors import AtlasError, shown
from atlas_drake.robot import Robot

WorldMaker: TypeAlias = Callable[[MultibodyPlant], None]
"""A callable that adds models to a plant before it is finalized."""


class WorldError(AtlasError, ValueError):
    """Raised if a world cannot be added to a plant."""


def listed(world: Iterable[WorldMaker]) -> tuple[WorldMaker, ...]:
    """Returns the callables of a world, which must be a list of them."""
    makers = tuple(world) if isinstance(world, Iterable) else ()
    if not (isinstance(world, Iterable) and all(map(callable, makers))):
        wanted = "a list of callables (plant) -> None"
        raise WorldError(f"world must be {wanted}, is {shown(world)}")
    return makers


def add_world(plant: MultibodyPlant, world: Sequence[WorldMaker]) -> None:
    """Adds everything beside robot and ground to a plant (before Finalize)."""
    for index, add in enumerate(listed(world)):
        add(plant)
        if plant.is_finalized():
            raise WorldError(f"world[{index}] must not finalize the plant")


def world_instances(
    plant: MultibodyPlant, robot: Robot
) -> dict[ModelInstanceIndex, str]:
    """Returns the models beside the robot that can move, with their names."""
    own = robot.instance(plant)
    indices = map(ModelInstanceIndex, range(plant.num_model_instances()))
    return {
        index: plant.GetModelInstanceName(index)
        for index in indices
        if index != own and plant.num_multibody_states(index)
    }


def put_world_back(plant: MultibodyPlant, context: Context, robot: Robot) -> None:
    """Resets every model beside the robot to its default state; the robot's stays."""
    instances = world_instances(plant, robot)
    if not instances:
        return
    default = plant.CreateDefaultContext()
    for instance in instances:
        state = plant.GetPositionsAndVelocities(default, instance)
        plant.SetPositionsAndVelocities(context, instance, state)


class Overlap(NamedTuple):
    """A body of the robot that is inside something else."""

    body: str
    model: str
    """Name of the other model, or of the geometry if it is the world's own."""
    depth: float
    """Length of the shortest way out [m]."""


def overlaps_with_world(
    plant: MultibodyPlant, context: Context, robot: Robot, but: Collection[str] = ()
) -> list[Overlap]:
    """Returns where the robot is inside other models; a touch is a small depth.

    Geometries of the world body whose names are in ``but`` do not count. Without a
    scene graph around the context nothing is known, and nothing returned.
    """
    port = plant.get_geometry_query_input_port()
    if not port.HasValue(context):
        return []
    query = port.Eval(context)
    inspector = query.inspector()
    own = robot.instance(plant)
    found = []
    for pair in query.ComputePointPairPenetration():
        ids = (pair.id_A, pair.id_B)
        bodies = [plant.GetBodyFromFrameId(inspector.GetFrameId(g)) for g in ids]
        is_own = [body.model_instance() == own for body in bodies]
        if is_own[0] == is_own[1]:
            continue
        mine, other = (0, 1) if is_own[0] else (1, 0)
        model = plant.GetModelInstanceName(bodies[other].model_instance())
        if bodies[other].index() == plant.world_body().index():
            model = inspector.GetName(ids[other])
            if model in but:
                continue
        found.append(Overlap(bodies[mine].name(), model, pair.depth))
    return found
