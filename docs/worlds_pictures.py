"""The pictures of worlds.md: each world that comes along, as the 3D view shows it.

``make_pictures`` calls it.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from extending_pictures import shrink

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.clients.view.viewer import start_meshcat
from atlas_drake.worlds.world_file import available_worlds

ABOVE = np.array([2.5, -19.0, 20.0]), np.array([9.5, 2.0, 0.0])
"""Lens and target of the view of the tutorial's whole world, in W [m]."""


def make_worlds_pictures(folder: Path, photograph: Callable[[str, Path], None]) -> None:
    """Makes the pictures of worlds.md.

    Args:
        folder: Where to.
        photograph: Takes one of a web page.
    """
    for name in available_worlds():
        meshcat = start_meshcat()
        sim = AtlasSimulation(Scenario(world=name), view=meshcat)
        sim.advance(0.1)
        _keep(folder / f"world_{name}.png", meshcat.StaticHtml(), photograph)
        if name == "qual_task_1":
            meshcat.SetCameraPose(*ABOVE)
            page = meshcat.StaticHtml()
            _keep(folder / f"world_{name}_above.png", page, photograph)
        meshcat.Delete()


def _keep(picture: Path, page: str, photograph: Callable[[str, Path], None]) -> None:
    photograph(page, picture)
    shrink(picture)
