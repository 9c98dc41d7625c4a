"""Films a run: the robot, its footsteps, overlays and a caption.

Reads ports and passes pictures to a file; filming never changes the simulation.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.framework import Context, DiagramBuilder, System

from atlas_drake.config import is_whole
from atlas_drake.errors import shown
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.models import world_of
from atlas_drake.scenario.terrain import Block
from atlas_drake.scenario.world import WorldMaker
from atlas_drake.scenario.world_file import View
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.seen import ViewInputs, see
from atlas_drake.visualization.video_camera import camera_pose, follow, looking_at
from atlas_drake.visualization.video_file import VideoError, VideoFile
from atlas_drake.visualization.video_overlays import VideoOverlays
from atlas_drake.visualization.video_stage import VideoStage

VIDEO_RATE = 25
"""Pictures per simulated second [1/s]."""
TITLE_HEIGHT, NOTE_HEIGHT, MARGIN = 0.055, 0.030, 0.045
"""Height of the caption's letters and distance from the edges, as shares of the
height."""
INK = (33, 43, 56)
"""Red, green and blue of the letters."""


@dataclass(frozen=True)
class Video:
    """Settings of a video: path, and size of its pictures [pixel]."""

    path: Path
    width: int = 960
    height: int = 540

    def __post_init__(self) -> None:
        """Take a name as a path.

        Raises:
            TypeError: If a field is of the wrong type; it names the field.
        """
        if not isinstance(self.path, str | PathLike):
            raise TypeError(
                f"path of a Video must be the name of a file, is {shown(self.path)}"
            )
        object.__setattr__(self, "path", Path(self.path))
        for name in ("width", "height"):
            value = getattr(self, name)
            if not (is_whole(value) and value > 0):
                raise TypeError(
                    f"{name} of a Video must be a positive whole number, is "
                    f"{shown(value)}"
                )


class VideoDisplay(CollectableSystem):
    """Takes a picture every 1 / VIDEO_RATE seconds.

    Past pictures and the camera's target belong to the file, as with Drake's own video
    writers, and not to the state of the simulation.

    Input ports are those of ``RecordInputs``, and the state of robot and world:
        plant_state: Configuration first.

    Attributes:
        fault: Error that ended the filming; None if there was none.
    """

    def __init__(
        self,
        video: Video,
        robot: Robot,
        catalog: BehaviorCatalog,
        terrain: Sequence[Block],
        world: Sequence[WorldMaker],
        overlays: Overlays,
        view: View | None,
    ) -> None:
        """Opens the file.

        Args:
            video: Settings of the video.
            robot: Robot in the picture.
            catalog: Its behaviors.
            terrain: Boxes on the ground.
            world: Models beside the robot.
            overlays: Switches of the overlays.
            view: Camera of the world; None, and with the overlay ``follow``, for a
                camera that follows the robot.

        Raises:
            VideoError: If the video cannot be made.
        """
        super().__init__()
        self.fault: VideoError | None = None
        self._file = VideoFile(video.path, VIDEO_RATE, video.width, video.height)
        self._fixed: RigidTransform | None = None
        X_TC = None
        if view is not None and not overlays.is_on("follow"):
            lens, target = np.array(view.lens), np.array(view.target)
            self._fixed = looking_at(lens, target)
            X_TC = RigidTransform(self._fixed.rotation(), lens - target)
        size = video.width, video.height
        self._stage = VideoStage(robot, terrain, *size, world, X_TC)
        self._drawing = VideoOverlays(robot, self._stage)
        self.inputs = ViewInputs(self, overlays)
        self._see = partial(see, robot=robot, catalog=catalog, overlays=overlays)
        self._plant_state = self.DeclareVectorInputPort(
            "plant_state", self._stage.num_states
        )
        self._target: NDArray[np.float64] | None = None
        self._yaw = 0.0
        self.DeclarePeriodicPublishEvent(1.0 / VIDEO_RATE, 0.0, self._publish)

    @property
    def closed(self) -> bool:
        """True once filming has ended."""
        return not self._file.is_open

    @property
    def num_frames(self) -> int:
        """Number of pictures of the video."""
        return self._file.num_frames

    def close(self) -> int:
        """Finishes the file, ends filming, and returns the number of pictures.

        Raises:
            VideoError: If the file cannot be written, now or at an earlier picture.
        """
        if self.fault is not None:
            raise self.fault
        self._file.close()
        return self.num_frames

    def _publish(self, context: Context) -> None:
        if not self._file.is_open:
            return
        seen = self._see(self.inputs.shown(context))
        pose = self._fixed or self._following(seen.record.state.q)
        q = self._plant_state.Eval(context)[: self._stage.num_positions]
        picture = self._stage.picture(q, seen.footsteps, pose)
        captioned = with_caption(
            self._drawing.onto(picture, seen.shapes, seen.joint_colors, pose),
            seen.title,
            "\n".join(seen.notes),
            context.get_time(),
        )
        try:
            self._file.add(captioned)
        except VideoError as error:
            # The simulation continues.
            self.fault = error

    def _following(self, q: NDArray[np.float64]) -> RigidTransform:
        """Returns the next pose of the camera that follows the pelvis."""
        if self._target is None:
            self._yaw = RollPitchYaw(
                Quaternion(q[:4] / np.linalg.norm(q[:4]))
            ).yaw_angle()
        self._target = follow(self._target, q[4:7], 1.0 / VIDEO_RATE)
        return camera_pose(self._target, self._yaw)


def with_caption(
    picture: NDArray[np.uint8], title: str, note: str, time: float
) -> NDArray[np.uint8]:
    """Draws title and note in the upper left corner of a picture, and the time [s]."""
    from PIL import Image, ImageDraw

    image = Image.fromarray(picture)
    height, margin = image.height, MARGIN * image.height
    draw = ImageDraw.Draw(image)
    large, small = _font(TITLE_HEIGHT * height), _font(NOTE_HEIGHT * height)
    draw.text((margin, margin), title.upper(), INK, large)
    draw.text((margin, margin + 1.3 * TITLE_HEIGHT * height), note, INK, small)
    right = image.width - margin
    draw.text((right, margin), f"{time:.1f} s", INK, small, anchor="ra")
    return np.array(image)


@cache
def _font(size: float) -> Any:
    """Loads letters of a height [pixel]; cached, because loading is slow."""
    from PIL import ImageFont

    return ImageFont.load_default(size)


def add_video(
    builder: DiagramBuilder,
    station: System,
    robot: Robot,
    catalog: BehaviorCatalog,
    scenario: Scenario,
    video: Video,
    world: Iterable[WorldMaker] = (),
    overlays: Overlays | None = None,
) -> None:
    """Adds a ``VideoDisplay`` named ``video`` to a diagram that holds a station.

    Args:
        builder: Builder of the diagram that holds the station.
        station: An AtlasStation, or the replay of one.
        robot: Robot in the picture.
        catalog: Its behaviors.
        scenario: Its terrain, models and camera are in the picture.
        video: Settings of the video.
        world: Models beside those of the scenario.
        overlays: Switches of the overlays.

    Raises:
        VideoError: If the video cannot be made.
    """
    overlays = overlays or Overlays()
    terrain, view = scenario.all_terrain(), scenario.surroundings().view
    world = (*world_of(scenario.all_models()), *world)
    display = VideoDisplay(video, robot, catalog, terrain, world, overlays, view)
    builder.AddNamedSystem("video", display)
    display.inputs.connect(builder, station)
