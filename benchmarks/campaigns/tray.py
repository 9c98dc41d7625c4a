"""A tray with a glass carried for five meters, as a trial."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake import AtlasSimulation

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "16_tray.py"))


def served(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Carries the tray, as the example does.

    Args:
        sim: A robot that stands before the world ``tray``.
        parameters: None.

    Returns:
        Whether the robot ``stands``, how far the tray ``leaned`` [rad] at
        most, how far the glass ``slid`` on it [m] and has ``tipped`` or turned [rad].
    """
    start = sim.frame_pose("tray").InvertAndCompose(sim.frame_pose("glass"))
    leaned = EXAMPLE["serve"](sim)
    way = start.InvertAndCompose(
        sim.frame_pose("tray").InvertAndCompose(sim.frame_pose("glass"))
    )
    return {
        "stands": not sim.has_fallen,
        "leaned": float(leaned),
        "slid": float(np.linalg.norm(way.translation())),
        "tipped": way.rotation().ToAngleAxis().angle(),
    }
