"""The wheel of a valve turned by a quarter, as a trial: other friction and places."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake import AtlasSimulation

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "13_valve.py"))


def turned(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Turns the wheel, as the example does.

    Args:
        sim: A robot that stands before the world ``valve``.
        parameters: ``friction`` of the wheel [N·m·s/rad], and how far the robot stands
            too far ``ahead`` and to the ``left`` [m].

    Returns:
        Whether the robot ``stands``, and how far the wheel is ``turned`` [rad].
    """
    friction = sim.plant.GetJointByName("turn")
    friction.SetDamping(sim.part("plant")[1], float(parameters["friction"]))
    EXAMPLE["turn"](sim, float(parameters["ahead"]), float(parameters["left"]))
    return {"stands": not sim.has_fallen, "turned": float(EXAMPLE["turned"](sim))}
