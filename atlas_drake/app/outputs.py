"""What the command line asks to be watched and kept: 3D view, recording, video.

The same for a run and for the replay of its log. Serving the view is in ``viewer``.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from pydrake.geometry import Meshcat

from atlas_drake.app.progress import Progress
from atlas_drake.app.viewer import await_viewer, start_meshcat
from atlas_drake.errors import AtlasError, ScenarioError
from atlas_drake.visualization import FRAME_RATE
from atlas_drake.whole_file import whole_file, why_not_writable

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video


T = TypeVar("T")

WEB_PAGES = (".html", ".htm")
"""How the name of a recording may end."""


def check_outputs(options: argparse.Namespace, names: Collection[str]) -> None:
    """Refuses a path now rather than after the run.

    Args:
        options: Of the command line; those that are None ask for no file.
        names: Of the options that name a file to write.

    Raises:
        ScenarioError: If a file cannot be written, or would take the place of another.
    """
    taken = {}
    for name in ("scenario", "log"):
        read = getattr(options, name, None)
        if read is not None and name not in names:
            taken[read.resolve()] = f"the {name} that is read"
    for name in names:
        path = getattr(options, name)
        if path is None:
            continue
        option = f"--{name}"
        check_writable(option, path)
        if name == "record" and path.suffix not in WEB_PAGES:
            raise ScenarioError(
                option, str(path), f"{path} must end in .html: it is a web page"
            )
        before = taken.setdefault(path.resolve(), option)
        if before != option:
            raise ScenarioError(option, str(path), f"{path} is {before} already")


def keep(
    path: Path,
    write: Callable[[], T],
    progress: Progress,
    use: Callable[[T], str] = lambda _written: ".",
) -> bool:
    """Writes a file at the end of a run; says whether that went well.

    What cannot be written takes nothing with it that can.

    Args:
        path: Of the file.
        write: Writes it.
        progress: Tells the user.
        use: From what ``write`` returns, what there is to say of the file: the end of
            the sentence that names it.
    """
    try:
        written = write()
    except (OSError, AtlasError) as error:
        problem = getattr(error, "strerror", None) or str(error)
        for known in (f"{path}: ", "cannot be written: "):
            problem = problem.removeprefix(known)
        progress.say(f"! {path} is lost: {problem}")
        return False
    progress.say(f"Wrote {path}{use(written)}")
    return True


def keep_text(path: Path, text: str, progress: Progress, use: str = ".") -> bool:
    """Writes a text file at the end of a run, as ``keep`` does, whole or not at all."""

    def write() -> None:
        with whole_file(path) as unfinished:
            unfinished.write_text(text, encoding="utf-8")

    return keep(path, write, progress, lambda _written: use)


def keep_video(path: Path, finish: Callable[[], int], progress: Progress) -> bool:
    """Completes a video, as ``keep`` does.

    Args:
        path: Of the video.
        finish: Completes it and returns how many pictures it has.
        progress: Tells the user.
    """
    return keep(path, finish, progress, lambda pictures: f", {pictures} pictures.")


def check_writable(option: str, path: Path) -> None:
    """Refuses a path now rather than after the run.

    Raises:
        ScenarioError: If no file can be written there.
    """
    problem = why_not_writable(path)
    if problem is not None:
        raise ScenarioError(option, str(path), problem)


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
    meshcat = start_meshcat(options.host, options.port, progress.say)
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
        await_viewer(meshcat, progress.say)


def realtime_rate(options: argparse.Namespace) -> float:
    """Simulated seconds per second, at most; 0 is as fast as possible."""
    if options.realtime_rate is not None:
        return float(options.realtime_rate)
    return 0.0 if options.headless else 1.0


def keep_recording(
    meshcat: Meshcat | None, options: argparse.Namespace, progress: Progress
) -> bool:
    """Writes the recording, if there is to be one; says whether that went well."""
    if meshcat is None or options.record is None:
        return True
    meshcat.StopRecording()
    meshcat.PublishRecording()
    use = "; open it in a browser."
    return keep_text(options.record, meshcat.StaticHtml(), progress, use)
