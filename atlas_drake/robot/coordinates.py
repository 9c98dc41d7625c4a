"""Coordinates of a robot and of other models in one plant."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.robot.robot import Robot


def own_places(plant: MultibodyPlant, robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Returns the places of the robot's positions and velocities in a plant's state."""
    own, num_q = robot.instance(plant), plant.num_positions()
    places = np.arange(plant.num_multibody_states(), dtype=float)
    q = plant.GetPositionsFromArray(own, places[:num_q])
    v = plant.GetVelocitiesFromArray(own, places[num_q:])
    return q.astype(int), v.astype(int)


def coordinates_beside(
    plant: MultibodyPlant, robot: Robot
) -> dict[str, dict[str, int]]:
    """Finds the coordinates of a finalized plant that are not the robot's.

    Returns:
        Place in the plant's state by the coordinate's name, for positions ``q`` and
        velocities ``v``; empty if there are no other coordinates.
    """
    own = set(np.concatenate(own_places(plant, robot)).tolist())
    names = [*plant.GetPositionNames(), *plant.GetVelocityNames()]
    others = {name: place for place, name in enumerate(names) if place not in own}
    num_q = plant.num_positions()
    if not others:
        return {}
    return {
        "q": {name: place for name, place in others.items() if place < num_q},
        "v": {name: place for name, place in others.items() if place >= num_q},
    }
