"""Coordinates of the models beside the robot: in a log's rows, and back in a plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.robot import Robot
from atlas_drake.scenario.world import WorldMaker, add_world


@dataclass(frozen=True)
class WorldCoordinates:
    """Places of the coordinates in a plant that are not the robot's.

    Attributes:
        places: Index into the state of the whole plant by the name of the coordinate,
            for each of the log's channels that exist.
        num_states: Number of states of the whole plant.
    """

    places: dict[str, dict[str, int]]
    num_states: int


def world_coordinates(robot: Robot, world: Sequence[WorldMaker]) -> WorldCoordinates:
    """Find the coordinates that ``world`` adds to a station's plant.

    Raises:
        WorldError: If it cannot be added.
    """
    plant = MultibodyPlant(time_step=0.0)
    # Models may have geometry, which is not used; the plant does not keep it alive.
    geometry = SceneGraph()
    if world:
        plant.RegisterAsSourceForSceneGraph(geometry)
    robot.add_to(plant)
    add_world(plant, world)
    plant.Finalize()
    return coordinates_beside(plant, robot)


def coordinates_beside(plant: MultibodyPlant, robot: Robot) -> WorldCoordinates:
    """Find the coordinates of a finalized plant that are not the robot's."""
    own = set(np.concatenate(_own_places(plant, robot)).tolist())
    names = [*plant.GetPositionNames(), *plant.GetVelocityNames()]
    others = {name: i for i, name in enumerate(names) if i not in own}
    num_q, places = plant.num_positions(), {}
    if others:
        places["world.q"] = {name: i for name, i in others.items() if i < num_q}
        places["world.v"] = {name: i for name, i in others.items() if i >= num_q}
    return WorldCoordinates(places, plant.num_multibody_states())


def _own_places(plant: MultibodyPlant, robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Index into the plant's state of the robot's positions and velocities."""
    own, num_q = robot.instance(plant), plant.num_positions()
    places = np.arange(plant.num_multibody_states(), dtype=float)
    q = plant.GetPositionsFromArray(own, places[:num_q])
    v = plant.GetVelocitiesFromArray(own, places[num_q:])
    return q.astype(int), v.astype(int)


class PlantState:
    """The state of a plant with robot and world, from a log's rows.

    Coordinates that the log does not hold keep their default values.
    """

    def __init__(
        self, plant: MultibodyPlant, robot: Robot, labels: Mapping[str, Sequence[str]]
    ) -> None:
        """Takes a finalized plant and the elements of the log's channels by name."""
        self._default = plant.GetPositionsAndVelocities(plant.CreateDefaultContext())
        q, v = _own_places(plant, robot)
        self._parts = [("state.q", np.arange(len(q)), q)]
        self._parts.append(("state.v", np.arange(len(v)), v))
        for name, places in coordinates_beside(plant, robot).places.items():
            kept = labels.get(name, ())
            columns = [column for column, label in enumerate(kept) if label in places]
            targets = [places[kept[column]] for column in columns]
            self._parts.append((name, np.array(columns), np.array(targets)))

    @property
    def size(self) -> int:
        """Length of the state."""
        return len(self._default)

    def at(self, arrays: Mapping[str, np.ndarray], row: int) -> np.ndarray:
        """Return the state at a row of a log's arrays, positions first."""
        state = self._default.copy()
        for name, columns, places in self._parts:
            if places.size:
                state[places] = arrays[name][row][columns]
        return state
