"""Pictures into a file: MP4 with H.264, or an animated GIF, one picture at a time.

Nothing here is specific to robots. The packages are an extra, loaded when needed.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.atomic_write import why_not_writable
from atlas_drake.errors import AtlasError

ENDINGS = (".mp4", ".gif")
INSTALL = 'pip install "atlas-drake[video]"'
PACKAGES = ("av", "PIL")
"""Packages of the extra: encoders, text and palettes."""
QUALITY = "23"
"""Constant rate factor of H.264: 18 has no visible loss, 28 is visibly poor."""


class VideoError(AtlasError):
    """A video cannot be made as asked."""


def check_video(path: Path, width: int, height: int) -> None:
    """Checks that a video of this size [pixel] can be made, before the run.

    Raises:
        VideoError: If the ending is unknown, a package is missing, the format cannot
            have this size, or no file can be written there.
    """
    if path.suffix not in ENDINGS:
        raise VideoError(f"--video: {path}: must end in {' or '.join(ENDINGS)}")
    if path.suffix == ".mp4" and (width % 2 or height % 2):
        raise VideoError(f"--video-size: {width}x{height}: an .mp4 needs even numbers")
    problem = why_not_writable(path)
    if problem is not None:
        raise VideoError(f"--video: {problem}")
    for package in PACKAGES:
        try:
            importlib.import_module(package)
        except ImportError as error:
            raise VideoError(
                f"--video: needs packages that are not installed: {INSTALL}"
            ) from error


class VideoFile:
    """Encodes each picture at once, so that a long video needs little memory."""

    def __init__(self, path: Path, rate: int, width: int, height: int) -> None:
        """Opens the file for pictures of this size [pixel], so many per second.

        Raises:
            VideoError: See ``check_video``.
        """
        check_video(path, width, height)
        import av

        self._gif = path.suffix == ".gif"
        self._path = path
        options = {} if self._gif else {"movflags": "+faststart"}
        self._container: Any = None
        with self._named_faults():
            self._container = av.open(str(path), "w", options=options)
        codec = "gif" if self._gif else "libx264"
        self._stream = self._container.add_stream(codec, rate)
        self._stream.width, self._stream.height = width, height
        self._stream.pix_fmt = "pal8" if self._gif else "yuv420p"
        if not self._gif:
            self._stream.options = {"crf": QUALITY}
        self._time_base = Fraction(1, rate)
        self.num_frames = 0

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Appends a picture, shape (height, width, 3), unless the file is closed.

        Raises:
            VideoError: If it cannot be written. The file is then deleted.
        """
        if self._container is None:
            return
        import av

        content: Any = _indexed(picture) if self._gif else picture
        kind = "pal8" if self._gif else "rgb24"
        frame = av.VideoFrame.from_ndarray(content, format=kind)
        frame.pts, frame.time_base = self.num_frames, self._time_base
        with self._named_faults():
            self._container.mux(self._stream.encode(frame))
        self.num_frames += 1

    def close(self) -> None:
        """Finishes the file, which cannot be played before.

        Raises:
            VideoError: If it cannot be written. The file is then deleted.
        """
        if self._container is None:
            return
        with self._named_faults():
            if self.num_frames:
                self._container.mux(self._stream.encode())
            self._container.close()
        self._container = None

    @property
    def is_open(self) -> bool:
        """True while pictures can be added."""
        return self._container is not None

    @contextmanager
    def _named_faults(self) -> Iterator[None]:
        """Names the file in a write error, and deletes the unplayable file."""
        import av

        try:
            yield
        except (av.error.FFmpegError, OSError) as error:
            container, self._container = self._container, None
            if container is not None:
                with suppress(av.error.FFmpegError, OSError):
                    container.close()
            # Never delete a device or a pipe.
            if self._path.is_file():
                self._path.unlink()
            problem = getattr(error, "strerror", None) or error
            raise VideoError(f"{self._path}: cannot be written: {problem}") from error


def _indexed(picture: NDArray[np.uint8]) -> tuple[Any, Any]:
    """Reduces a picture to 256 colors of its own, as a GIF holds it."""
    from PIL import Image

    image = Image.fromarray(picture)
    indexed = image.quantize(method=Image.Quantize.FASTOCTREE)
    colors = np.array(indexed.getpalette("RGB"), dtype=np.uint8).reshape(-1, 3)
    palette = np.full((256, 4), 255, dtype=np.uint8)  # Alpha, red, green, blue.
    palette[: len(colors), 1:] = colors
    return np.array(indexed), palette
