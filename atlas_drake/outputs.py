"""What the command line asks to be watched and kept: 3D view, recording, video.

The same for a run and for the replay of its log. Serving the view is in ``viewer``.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from pydrake.geometry import Meshcat

from atlas_drake.errors import ScenarioError
from atlas_drake.progress import Progress
from atlas_drake.viewer import await_viewer, interactive, start_meshcat
from atlas_drake.visualization import FRAME_RATE

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video


def check_writable(option: str, path: Path | None) -> None:
    """Refuses a path now rather than after the run; None is no path and no fault.

    Raises:
        ScenarioError: If no file can be written there.
    """
    if path is None:
        return
    folder = path.parent
    if path.is_dir():
        raise ScenarioError(option, str(path), f"{path} is a folder")
    if not folder.is_dir():
        raise ScenarioError(option, str(path), f"there is no folder {folder}")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise ScenarioError(option, str(path), f"{path} cannot be written")


def video_asked_for(options: argparse.Namespace) -> Video | None:
    """What is asked of a video, if there is to be one.

    Raises:
        VideoError: If it cannot be made.
    """
    if options.video is None:
        return None
    from atlas_drake.visualization.video_display import Video
    from atlas_drake.visualization.video_file import check_video

    check_video(options.video, *options.video_size)
    return Video(options.video, *options.video_size)


def open_view(options: argparse.Namespace, progress: Progress) -> Meshcat | None:
    """Serves a 3D view if somebody watches it or it is recorded.

    To be called before the diagram is built, whose first picture belongs to the
    recording.

    Raises:
        ScenarioError: If its address cannot be had.
    """
    if options.headless and options.record is None:
        return None
    meshcat = start_meshcat(options.host, options.port, progress)
    if options.record is not None:
        meshcat.StartRecording(
            frames_per_second=FRAME_RATE,
            set_visualizations_while_recording=not options.headless,
        )
    return meshcat


def invite_viewer(
    meshcat: Meshcat | None, options: argparse.Namespace, progress: Progress
) -> None:
    """Says where to watch, and gives a browser the time to open."""
    if meshcat is not None and not options.headless:
        progress.say(f"Watch at {meshcat.web_url()}")
        if interactive():
            await_viewer(meshcat, progress)


def realtime_rate(options: argparse.Namespace) -> float:
    """Simulated seconds per second, at most; 0 is as fast as possible."""
    if options.realtime_rate is not None:
        return float(options.realtime_rate)
    return 0.0 if options.headless else 1.0


def keep_recording(
    meshcat: Meshcat | None, options: argparse.Namespace, progress: Progress
) -> None:
    """Writes the recording, if there is to be one."""
    if meshcat is not None and options.record is not None:
        meshcat.StopRecording()
        meshcat.PublishRecording()
        options.record.write_text(meshcat.StaticHtml())
        progress.say(f"Wrote {options.record}; open it in a browser.")
