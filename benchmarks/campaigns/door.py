"""A door pushed open and walked through, as a trial: other weight and places."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake import AtlasSimulation

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "14_door.py"))


def passed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Opens the door and walks through, as the example does.

    Args:
        sim: A robot that stands before the world ``door``.
        parameters: ``friction`` of the hinge [N·m·s/rad].

    Returns:
        Whether the robot ``stands``, how far the door is ``opened`` [rad], and how far
        the pelvis is ``beyond`` it [m].
    """
    hinge = sim.plant.GetJointByName("hinge")
    hinge.SetDamping(sim.part("plant")[1], float(parameters["friction"]))
    EXAMPLE["walk_through"](sim)
    way = sim.pelvis_pose.translation() - sim.frame_pose("post").translation()
    return {
        "stands": not sim.has_fallen,
        "opened": float(EXAMPLE["opened"](sim)),
        "beyond": float(way[0]),
    }
