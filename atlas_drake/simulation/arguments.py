"""Checks the types of those arguments of ``AtlasSimulation`` without other checks.

Controllers, behaviors, worlds and extensions are checked by the parts that use them.
"""

from __future__ import annotations

import os

from pydrake.geometry import Meshcat

from atlas_drake.errors import shown
from atlas_drake.scenario import Scenario
from atlas_drake.visualization.overlays import Overlays


def check_arguments(
    scenario: object,
    view: object,
    overlays: object,
    video: object,
    on_event: object,
    log: object,
) -> None:
    """Checks arguments before the simulation is built.

    Args:
        scenario: Argument of ``AtlasSimulation``, or None.
        view: Argument of ``AtlasSimulation``, or None.
        overlays: Argument of ``AtlasSimulation``, or None.
        video: Argument of ``AtlasSimulation``, or None.
        on_event: Argument of ``AtlasSimulation``, or None.
        log: Argument of ``AtlasSimulation``, or None.

    Raises:
        TypeError: If an argument has another type; names the argument and a correct
            value.
    """
    _check(
        isinstance(scenario, Scenario | None),
        "scenario must be a Scenario",
        scenario,
        "; load_scenario reads one from a file",
    )
    _check(
        isinstance(view, bool | Meshcat | None),
        "view must be True, False or a Meshcat of pydrake.geometry",
        view,
    )
    _check(
        isinstance(overlays, Overlays | None),
        "overlays must be Overlays of atlas_drake.visualization.overlays",
        overlays,
        ", such as Overlays(['com', 'dcm'])",
    )
    if video is not None:
        # The modules for video are loaded only for a run with a video.
        from atlas_drake.visualization.video_display import Video

        _check(
            isinstance(video, Video),
            "video must be a Video of atlas_drake.visualization.video_display",
            video,
            ", such as Video('run.mp4')",
        )
    _check(
        on_event is None or callable(on_event),
        "on_event must be a callable (event) -> None",
        on_event,
    )
    _check(
        isinstance(log, str | os.PathLike | None),
        "log must be the name of a file",
        log,
        ", such as 'run.npz'",
    )


def _check(sound: bool, requirement: str, value: object, instead: str = "") -> None:
    if not sound:
        raise TypeError(f"{requirement}, is {shown(value)}{instead}")
