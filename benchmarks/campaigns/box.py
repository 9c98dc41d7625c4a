"""A box pushed half a meter away, as a trial."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake import AtlasSimulation

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "15_box.py"))


def pushed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Pushes the box, as the example does.

    Args:
        sim: A robot that stands before the world ``box``.
        parameters: How far to push the box, ``way`` [m], and the ``place`` of the left
            palm at the pelvis [m].

    Returns:
        Whether the robot ``stands``, and how far the box was ``pushed`` [m].
    """
    way = EXAMPLE["push"](sim, float(parameters["way"]), parameters["place"])
    return {"stands": not sim.has_fallen, "pushed": float(way)}
