"""The pictures of robots.md: imported robots walk, side by side.

``make_pictures`` calls it. Needs ``pip install "atlas-drake[robots]"``.
"""

from __future__ import annotations

import itertools
import runpy
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from atlas_drake import AtlasSimulation, Scenario, StepStream, steps_ahead
from atlas_drake.clients.film.file import FilmFile
from atlas_drake.clients.film.film import RATE, photograph
from atlas_drake.clients.importing.report import FAR, robot_height
from atlas_drake.clients.logs import Log, read_log
from atlas_drake.worlds.world_file import View

FILMED = ("talos", "g1", "icub", "jvrc")
"""Robots of the film; the picture has all."""
TILE = (320, 416)
"""Size of each robot's picture [pixel]."""
STANDS, STEPS, LASTS = 1.0, 12, 8.0
"""Time before the first step [s], number of steps, and duration of the film [s]."""
SWING = 5.2
"""Time of the still picture, in Atlas' time [s]."""
CAMPAIGN = Path(__file__).parents[1] / "benchmarks" / "campaigns" / "robots.py"


def make_robots_pictures(folder: Path) -> None:
    """Makes the picture of all robots and the film of four.

    Args:
        folder: Where to.
    """
    campaign = runpy.run_path(str(CAMPAIGN))
    campaign["import_all"]()
    stills, films = [], []
    with tempfile.TemporaryDirectory() as temporary:
        for name in campaign["ROBOTS"]:
            log = _walk(
                campaign["FOLDER"] / name / "robot.yaml", Path(temporary) / name
            )
            view = _view(log)
            stills += photograph(log, [SWING], view, TILE)
            if name in FILMED:
                times = np.arange(0.0, LASTS, 1.0 / RATE).tolist()
                films.append(photograph(log, times, view, TILE))
    Image.fromarray(np.concatenate(stills, axis=1)).save(folder / "robots.png")
    width, height = TILE
    with FilmFile(folder / "robots.mp4", RATE, (width * len(films), height)) as film:
        for pictures in zip(*films, strict=True):
            film.add(np.ascontiguousarray(np.concatenate(pictures, axis=1)))
    small = (width * len(films) // 2, height // 2)
    with FilmFile(folder / "robots.gif", RATE // 2, small) as film:
        for pictures in itertools.islice(zip(*films, strict=True), 50, 150, 2):
            whole = Image.fromarray(np.concatenate(pictures, axis=1))
            film.add(np.asarray(whole.resize(small)))


def _walk(model: Path, log: Path) -> Log:
    """Walks a robot, and returns the log."""
    path = log.with_suffix(".mcap")
    with AtlasSimulation(Scenario(model=str(model)), log=path) as sim:
        sim.advance(STANDS)
        gait = sim.scenario.controller_config().gait()
        stride = min(1.4 * gait.stride, gait.longest_stride)
        gait = sim.scenario.controller_config().gait(stride=stride)
        report = sim.atlas_sim_interface_state
        stream = StepStream(steps_ahead(report, stride * (STEPS - 1), gait))
        while sim.time < LASTS:
            sim.publish(stream.next_command(sim.atlas_sim_interface_state))
            sim.advance(0.05)
    return read_log(path)


def _view(log: Log) -> View:
    """Returns a view from ahead and its right, in which each robot is as large."""
    h = robot_height(log.robot)
    lens = [0.8 * FAR * h, -0.6 * FAR * h, 0.75 * h]
    return View(lens, [0.0, 0.0, 0.5 * h])
