"""Pictures into a file: MP4 with H.264, or an animated GIF, one picture at a time.

Nothing here is specific to robots. The encoder is an extra, loaded when needed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.atomic_write import why_not_writable
from atlas_drake.errors import AtlasError

ENDINGS = (".mp4", ".gif")
QUALITY = "23"
"""Constant rate factor of H.264: 18 has no visible loss, 28 is visibly poor."""


class FilmError(AtlasError):
    """A film cannot be made as asked."""


def check_film(path: Path, size: tuple[int, int]) -> None:
    """Raises FilmError if no film of this width and height [pixel] can be made."""
    if path.suffix not in ENDINGS:
        raise FilmError(f"{path}: a film must end in {' or '.join(ENDINGS)}")
    if path.suffix == ".mp4" and any(side % 2 for side in size):
        raise FilmError(f"{path}: an .mp4 needs an even size, not {size[0]}x{size[1]}")
    problem = why_not_writable(path)
    if problem is not None:
        raise FilmError(problem)
    if find_spec("av") is None:
        raise FilmError('a film needs `pip install "atlas-drake[video]"`')


class FilmFile:
    """Encodes each picture at once, so that a long film needs little memory.

    Used as a context, it is completed at the end; it cannot be played before.
    """

    def __init__(self, path: Path, rate: int, size: tuple[int, int]) -> None:
        """Opens the file for pictures of this width and height, so many per second."""
        check_film(path, size)
        import av

        gif = path.suffix == ".gif"
        self._path = path
        self._container: Any = None
        with self._named_faults():
            options = {} if gif else {"movflags": "+faststart"}
            self._container = av.open(str(path), "w", options=options)
        self._stream = self._container.add_stream("gif" if gif else "libx264", rate)
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = "pal8" if gif else "yuv420p"
        if not gif:
            self._stream.options = {"crf": QUALITY}
        self._palette = _palette_filter(size, rate) if gif else None
        self._time_base = Fraction(1, rate)
        self.num_frames = 0

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Appends a picture, shape (height, width, 3); a fault deletes the file."""
        import av

        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        frame.pts, frame.time_base = self.num_frames, self._time_base
        with self._named_faults():
            if self._palette is not None:
                self._palette.push(frame)
                frame = self._palette.pull()
                frame.pts, frame.time_base = self.num_frames, self._time_base
            self._container.mux(self._stream.encode(frame))
        self.num_frames += 1

    def __enter__(self) -> FilmFile:
        return self

    def __exit__(self, *_error: object) -> None:
        """Completes the file."""
        if self._container is None:
            return
        with self._named_faults():
            if self.num_frames:
                self._container.mux(self._stream.encode())
            self._container.close()
        self._container = None

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
            raise FilmError(f"{self._path}: cannot be written: {problem}") from error


def _palette_filter(size: tuple[int, int], rate: int) -> Any:
    """Makes a filter that reduces each picture to 256 colors of its own, as GIF has."""
    import av.filter

    graph = av.filter.Graph()
    width, height = size
    source = graph.add_buffer(
        width=width,
        height=height,
        format=av.VideoFormat("rgb24"),
        time_base=Fraction(1, rate),
    )
    split, sink = graph.add("split"), graph.add("buffersink")
    colors = graph.add("palettegen", "stats_mode=single")
    use = graph.add("paletteuse", "new=1:dither=none")
    source.link_to(split)
    split.link_to(use, 0, 0)
    split.link_to(colors, 1, 0)
    colors.link_to(use, 0, 1)
    use.link_to(sink)
    graph.configure()
    return graph
