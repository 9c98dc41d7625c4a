"""A crate carried from one table to another, as a trial: other masses.

The limits are in the files of campaigns that name this one.
"""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.tree import SpatialInertia

from atlas_drake import AtlasSimulation
from atlas_drake.rotations import wrap_angle, yaw_of

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "12_crate.py"))
SIZE = (0.3, 0.4, 0.25)
"""Of the world's crate [m]."""


def carried(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Carries a crate over, as the example does.

    Args:
        sim: A robot that stands before the world ``tables``.
        parameters: ``mass`` of the crate [kg].

    Returns:
        Whether the robot ``stands``; how far the crate was ``lifted`` [m]; how far it
        is ``off`` its place [m] and ``turned`` [rad] at the end.
    """
    crate = sim.plant.GetBodyByName("crate")
    context = sim.plant.GetMyMutableContextFromRoot(sim.context)
    mass = float(parameters["mass"])
    inertia = SpatialInertia.SolidBoxWithMass(mass, *SIZE)
    crate.SetSpatialInertiaInBodyFrame(context, inertia)
    lifted = EXAMPLE["carry"](sim, mass)
    X_WC = sim.frame_pose("crate")
    turned = yaw_of(X_WC.rotation().matrix()) - EXAMPLE["ROBOT"][2]
    return {
        "stands": not sim.has_fallen,
        "lifted": float(lifted),
        "off": float(np.linalg.norm(X_WC.translation() - EXAMPLE["CRATE"])),
        "turned": abs(wrap_angle(turned)),
    }


def rests(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Leaves a crate alone.

    Args:
        sim: A robot that stands before the world ``tables``.
        parameters: ``seconds`` for which nobody touches the crate [s].

    Returns:
        How far it has ``moved`` [m] and ``turned`` [rad].
    """
    sim.advance(0.5)
    start = sim.frame_pose("crate")
    sim.advance(float(parameters["seconds"]))
    way = start.InvertAndCompose(sim.frame_pose("crate"))
    return {
        "moved": float(np.linalg.norm(way.translation())),
        "turned": way.rotation().ToAngleAxis().angle(),
    }
