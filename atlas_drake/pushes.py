"""Pushes on the robot's bodies, each for some time.

Forces for the plant's port; when they begin and end is asked by the simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant

from atlas_drake.errors import InvalidMessageError


@dataclass(frozen=True)
class Push:
    """A force on a body at its origin.

    Attributes:
        body: Name of the link.
        force_W: In W [N], shape (3,).
        end: Simulated time at which it ends [s].
    """

    body: str
    force_W: np.ndarray
    end: float

    def on(self, plant: MultibodyPlant) -> ExternallyAppliedSpatialForce:
        """As the plant's port takes it."""
        force = ExternallyAppliedSpatialForce()
        force.body_index = plant.GetBodyByName(self.body).index()
        force.F_Bq_W = SpatialForce(np.zeros(3), self.force_W)
        return force


def make_push(
    plant: MultibodyPlant,
    body: str,
    force_W: Sequence[float] | np.ndarray,
    duration: float,
    time: float,
) -> Push:
    """A push that begins at ``time`` [s].

    Args:
        plant: That has the body.
        body: Name of a link.
        force_W: Force in W [N], shape (3,).
        duration: How long [s], positive.
        time: Simulated time now [s].

    Raises:
        InvalidMessageError: If there is no such body or a value is no number.
    """
    force = np.asarray(force_W, dtype=float)
    if force.shape != (3,) or not np.isfinite(force).all():
        raise InvalidMessageError("force_W", force_W, "must be three finite numbers")
    if not (np.isfinite(duration) and duration > 0.0):
        raise InvalidMessageError("duration", duration, "must be positive")
    if not plant.HasBodyNamed(body):
        raise InvalidMessageError("body", body, f"the robot has no body {body!r}")
    return Push(body, force, time + duration)
