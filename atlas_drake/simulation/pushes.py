"""Pushes on the robot's bodies, each of limited duration.

Makes the forces for the plant's port; the simulation begins and ends them.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from atlas_drake.errors import InvalidMessageError, did_you_mean, shown
from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.robot import Robot
from atlas_drake.scenario.pushes import LARGEST_FORCE


@dataclass(frozen=True)
class Push:
    """A force on a body at its origin.

    Attributes:
        body: Name of the link.
        force_W: Force in W [N], shape (3,).
        end: Simulated time at which the push ends [s].
    """

    body: str
    force_W: np.ndarray
    end: float

    def on(self, plant: MultibodyPlant, robot: Robot) -> ExternallyAppliedSpatialForce:
        """Converts the push to the type of the plant's port."""
        force = ExternallyAppliedSpatialForce()
        force.body_index = plant.GetBodyByName(self.body, robot.instance(plant)).index()
        force.F_Bq_W = SpatialForce(np.zeros(3), self.force_W)
        return force


def make_push(
    bodies: Collection[str],
    body: str,
    force_W: Sequence[float] | np.ndarray,
    duration: float,
    time: float,
) -> Push:
    """Makes a push that begins at ``time`` [s].

    Args:
        bodies: Names of the robot's links.
        body: Name of the pushed link.
        force_W: Force in W [N], shape (3,).
        duration: Duration of the push [s], positive.
        time: Present simulated time [s].

    Raises:
        InvalidMessageError: If there is no such body or a value is invalid.
    """
    force = check_vector(force_W, "force_W", 3, LARGEST_FORCE)
    check_number(duration, "duration", 0.0, strictly=True)
    if body not in bodies:
        hint = did_you_mean(str(body), bodies) or f" It has {', '.join(bodies)}."
        problem = f"the robot has no body {shown(body)}.{hint}"
        raise InvalidMessageError("body", body, problem)
    return Push(body, force, time + duration)


class ActivePushes:
    """Pushes in force, as forces on the diagram's port.

    A force stays on the port between two calls of ``update``, which must therefore be
    called at the ends of pushes.
    """

    def __init__(self, diagram: Diagram, plant: MultibodyPlant, robot: Robot):
        """Takes the diagram, and the plant with the robot in it."""
        self._port = diagram.GetInputPort("applied_spatial_force")
        self._plant, self._robot = plant, robot
        self._pushes: list[Push] = []

    @property
    def ends(self) -> list[float]:
        """Times at which pushes end [s]."""
        return [push.end for push in self._pushes]

    def add(self, push: Push) -> None:
        """Adds a push, in force from the next ``update`` on."""
        self._pushes.append(push)

    def update(self, context: Context) -> None:
        """Puts the forces of the pushes that have not ended on the port.

        Args:
            context: Root context of the diagram.
        """
        if not self._pushes:
            return
        now = context.get_time() + 1e-9
        self._pushes = [push for push in self._pushes if push.end > now]
        self._exert(context)

    def clear(self, context: Context) -> None:
        """Ends all pushes.

        Args:
            context: Root context of the diagram.
        """
        self._pushes = []
        self._exert(context)

    def _exert(self, context: Context) -> None:
        forces = [push.on(self._plant, self._robot) for push in self._pushes]
        self._port.FixValue(context, forces)
