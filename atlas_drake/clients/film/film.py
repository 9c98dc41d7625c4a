"""Films a log: Drake's renderer over its records, into a video file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform

from atlas_drake.clients.film import FILM_SIZE
from atlas_drake.clients.film.camera import FilmCamera, looking_at
from atlas_drake.clients.film.file import FilmFile
from atlas_drake.clients.film.replay import make_replay_station
from atlas_drake.clients.film.stage import FilmStage, Picture
from atlas_drake.clients.logs import Log
from atlas_drake.clients.view.colors import joint_colors
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.shapes import Shape, shapes_of
from atlas_drake.records import TickRecord
from atlas_drake.worlds.world import WorldMaker
from atlas_drake.worlds.world_file import View

RATE = 25
"""Pictures per simulated second [1/s]."""


def photograph(
    log: Log, times: Sequence[float], view: View, size: tuple[int, int] = FILM_SIZE
) -> list[Picture]:
    """Takes pictures of a log.

    Args:
        log: Log of the run.
        times: Simulated times of the pictures [s].
        view: Place and target of the camera, relative to the pelvis' place on the
            ground; it does not turn with the robot.
        size: Width and height of the pictures [pixel].

    Returns:
        The pictures, each of shape (height, width, 3).

    Raises:
        FilmError: If the robot cannot be drawn.
    """
    lens, target = np.array(view.lens), np.array(view.target)
    studio = _Studio(log, size, looking_at(lens - target, np.zeros(3)))

    def camera(record: TickRecord) -> RigidTransform:
        place = np.append(record.pelvis.position[:2], 0.0)
        return looking_at(lens + place, target + place)

    return [studio.picture(time, camera) for time in times]


def film(
    log: Log,
    path: str | Path,
    *,
    size: tuple[int, int] = FILM_SIZE,
    show: Iterable[str] = (),
    view: View | None = None,
    world: Sequence[WorldMaker] = (),
    on_picture: Callable[[float], object] = lambda _time: None,
) -> int:
    """Films a log: the robot in its world, its footsteps, and overlays.

    An exception, such as that of Ctrl-C, ends the film with the pictures so far.

    Example:
        >>> film(read_log("run.mcap"), "run.mp4", show=["owner", "support"])

    Args:
        log: Log of the run.
        path: Path of the film, which ends in .mp4 or .gif.
        size: Width and height of the pictures [pixel].
        show: Names of overlays, see ``atlas_drake.clients.view.overlays``.
        view: Place and target of the camera. None is the view of the run's world, or,
            with the overlay ``follow`` or in a world without a view, a camera that
            follows the robot.
        world: The callables of the run's world. A log holds the appearance of the
            scenario's models, but only the motion of other models.
        on_picture: Called with the simulated time [s] after each picture.

    Returns:
        The number of pictures.

    Raises:
        FilmError: If the film cannot be made.
        ScenarioError: If there is no such overlay.
        LogError: If this version of the program cannot read the log's scenario.
    """
    overlays = Overlays(show)
    scenario = log.scenario
    if view is None and "follow" not in overlays.on:
        view = scenario.surroundings().view
    camera = FilmCamera(view, 1.0 / RATE)
    with FilmFile(Path(path), RATE, size) as file:
        studio = _Studio(log, size, camera.X_TC, overlays, world)
        begin, end = float(log.time[0]), float(log.time[-1])
        for number in range(math.floor((end - begin) * RATE + 1e-6) + 1):
            time = begin + number / RATE
            file.add(studio.picture(time, camera.pose))
            on_picture(time)
    return file.num_frames


class _Studio:
    """Replays a log before a camera."""

    def __init__(
        self,
        log: Log,
        size: tuple[int, int],
        X_TC: RigidTransform,
        overlays: Overlays | None = None,
        world: Sequence[WorldMaker] = (),
    ) -> None:
        """Sets up the scene; ``size`` is that of the pictures [pixel].

        X_TC is the pose of the camera from its target. Without ``overlays`` the robot
        is alone; with some, even with none switched on, its footsteps are shown as
        well. ``world`` comes beside the models of the log's scenario.
        """
        self._robot, self._overlays = log.robot, overlays

        def set_up(scene_graph: SceneGraph) -> None:
            self._stage = FilmStage(scene_graph, self._robot, size, X_TC)

        self._station = make_replay_station(log, world, set_up)
        self._context = self._station.CreateDefaultContext()
        scene_graph = self._station.GetSubsystemByName("scene_graph")
        self._scene = scene_graph.GetMyMutableContextFromRoot(self._context)

    def picture(
        self, time: float, camera: Callable[[TickRecord], RigidTransform]
    ) -> Picture:
        """Takes the picture of a time [s], from where the camera is for its record."""
        self._context.SetTime(time)
        record = self._station.GetOutputPort("record").Eval(self._context)
        query = self._station.GetOutputPort("query_object").Eval(self._context)
        shapes, colors = list[Shape](), None
        if self._overlays is not None:
            shapes = shapes_of(record, self._overlays.on, self._robot.file.sole)
            colors = joint_colors(record, self._overlays.on, self._robot)
        return self._stage.picture(self._scene, query, shapes, colors, camera(record))
