"""Checks the arguments of ``AtlasSimulation`` that nothing else checks, by their types.

Controllers, behaviors, worlds and extensions are checked by the parts that take them.
"""

from __future__ import annotations

import os

from pydrake.geometry import Meshcat

from atlas_drake.errors import shown
from atlas_drake.scenario import Scenario
from atlas_drake.visualization.overlays import Overlays


def check_arguments(
    scenario: object,
    meshcat: object,
    overlays: object,
    video: object,
    on_event: object,
    log: object,
) -> None:
    """Refuse what cannot be used, before anything is made.

    Args:
        scenario: As given to ``AtlasSimulation``, like the others; each may be None.
        meshcat: Likewise.
        overlays: Likewise.
        video: Likewise.
        on_event: Likewise.
        log: Likewise.

    Raises:
        TypeError: Naming the argument, and what to give instead.
    """
    _check(
        isinstance(scenario, Scenario | None),
        "scenario must be a Scenario",
        scenario,
        "; load_scenario reads one from a file",
    )
    _check(
        isinstance(meshcat, Meshcat | None),
        "meshcat must be a Meshcat of pydrake.geometry",
        meshcat,
        "; start_meshcat of atlas_drake.app.viewer starts one",
    )
    _check(
        isinstance(overlays, Overlays | None),
        "overlays must be Overlays of atlas_drake.visualization.overlays",
        overlays,
        ", such as Overlays(['com', 'dcm'])",
    )
    if video is not None:
        # What films loads only where there is something to film.
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
