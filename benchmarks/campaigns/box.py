"""A box pushed half a meter away, as a trial: other masses."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydrake.multibody.tree import SpatialInertia

from atlas_drake import AtlasSimulation

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "15_box.py"))
SIZE = (0.7, 0.6, 0.9)
"""Of the world's box [m]."""


def pushed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Pushes the box, as the example does.

    Args:
        sim: A robot that stands before the world ``box``.
        parameters: ``mass`` of the box [kg], how far to push it, ``way`` [m], and the
            ``place`` of the left palm at the pelvis [m].

    Returns:
        Whether the robot ``stands``, and how far the box was ``pushed`` [m].
    """
    inertia = SpatialInertia.SolidBoxWithMass(float(parameters["mass"]), *SIZE)
    box, context = sim.plant.GetBodyByName("box"), sim.part("plant")[1]
    box.SetSpatialInertiaInBodyFrame(context, inertia)
    way = EXAMPLE["push"](sim, float(parameters["way"]), parameters["place"])
    return {"stands": not sim.has_fallen, "pushed": float(way)}
