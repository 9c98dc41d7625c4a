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
        q: Index into the plant's positions by name of the coordinate.
        v: Index into the plant's velocities by name of the coordinate.
        num_positions: Number of positions of the whole plant.
        num_states: Number of states of the whole plant.
    """

    q: dict[str, int]
    v: dict[str, int]
    num_positions: int
    num_states: int

    @property
    def indices(self) -> dict[str, np.ndarray]:
        """Index into the state of the whole plant, by the name of the log's channel."""
        if not self.q:
            return {}
        return {
            "world.q": np.array([*self.q.values()]),
            "world.v": self.num_positions + np.array([*self.v.values()], dtype=int),
        }


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
    own = robot.instance(plant)
    all_q = np.arange(plant.num_positions(), dtype=float)
    all_v = np.arange(plant.num_velocities(), dtype=float)
    return WorldCoordinates(
        _others(plant.GetPositionNames(), plant.GetPositionsFromArray(own, all_q)),
        _others(plant.GetVelocityNames(), plant.GetVelocitiesFromArray(own, all_v)),
        plant.num_positions(),
        plant.num_multibody_states(),
    )


class PlantState:
    """The state of a plant with robot and world, from a log's rows.

    Coordinates that the log does not hold keep their default values.
    """

    def __init__(
        self, plant: MultibodyPlant, robot: Robot, labels: Mapping[str, Sequence[str]]
    ) -> None:
        """Takes a finalized plant and the elements of the log's channels by name."""
        self._default = plant.GetPositionsAndVelocities(plant.CreateDefaultContext())
        own, beside = robot.instance(plant), coordinates_beside(plant, robot)
        num_q = plant.num_positions()
        all_q = np.arange(num_q, dtype=float)
        all_v = num_q + np.arange(plant.num_velocities(), dtype=float)
        robot_q = plant.GetPositionsFromArray(own, all_q).astype(int)
        robot_v = plant.GetVelocitiesFromArray(own, all_v).astype(int)
        self._parts = [
            ("state.q", np.arange(len(robot_q)), robot_q),
            ("state.v", np.arange(len(robot_v)), robot_v),
        ]
        for name, places, offset in (
            ("world.q", beside.q, 0),
            ("world.v", beside.v, num_q),
        ):
            kept = labels.get(name, ())
            columns = [column for column, label in enumerate(kept) if label in places]
            targets = [offset + places[kept[column]] for column in columns]
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


def _others(names: Sequence[str], own: np.ndarray) -> dict[str, int]:
    """Index by name of all coordinates but those at the indices ``own``."""
    taken = set(own.astype(int).tolist())
    return {name: i for i, name in enumerate(names) if i not in taken}
