"""Checks the types of those arguments of ``AtlasSimulation`` without other checks.

Controllers, behaviors, worlds and extensions are checked by the parts that use them.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from pydrake.geometry import Meshcat

from atlas_drake.errors import shown
from atlas_drake.scenario import Scenario
from atlas_drake.visualization.overlays import Overlays

_RULES: dict[str, tuple[Any, str]] = {
    "scenario": (Scenario, "a Scenario{}; load_scenario reads one from a file"),
    "view": (bool | Meshcat, "True, False or a Meshcat of pydrake.geometry{}"),
    "overlays": (
        Overlays,
        "Overlays of atlas_drake.visualization.overlays{}, such as "
        "Overlays(['com', 'dcm'])",
    ),
    "on_event": (Callable, "a callable (event) -> None{}"),
    "log": (str | os.PathLike, "the name of a file{}, such as 'run.npz'"),
}
"""Type of each argument, and what an error says around the given value."""


def check_arguments(**arguments: object) -> None:
    """Checks arguments of ``AtlasSimulation`` before it is built; None is valid.

    Raises:
        TypeError: If an argument has another type; names the argument and a correct
            value.
    """
    rules = dict(_RULES)
    if arguments.get("video") is not None:
        # The modules for video are loaded only for a run with a video.
        from atlas_drake.visualization.video_display import Video

        rules["video"] = (
            Video,
            "a Video of atlas_drake.visualization.video_display{}, such as "
            "Video('run.mp4')",
        )
    for name, value in arguments.items():
        if value is None:
            continue
        kind, requirement = rules[name]
        if not isinstance(value, kind):
            raise TypeError(
                f"{name} must be {requirement.format(f', is {shown(value)}')}"
            )
