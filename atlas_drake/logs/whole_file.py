"""Files that appear under their name when they are whole, or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Gives a path to write to, whose file becomes ``path`` unless an error comes."""
    unfinished = path.with_name(f".{path.stem}.unfinished{path.suffix}")
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


class WholeFile:
    """The same for a file that stays open for long.

    Attributes:
        file: To write to, in binary.
    """

    def __init__(self, path: Path):
        """Opens the file.

        Raises:
            OSError: If it cannot be written.
        """
        with ExitStack() as stack:
            unfinished = stack.enter_context(whole_file(path))
            self.file: IO[bytes] = stack.enter_context(unfinished.open("wb"))
            self._stack = stack.pop_all()

    def __enter__(self) -> IO[bytes]:
        return self.file

    def __exit__(self, *error: Any) -> bool | None:
        """Closes the file and, unless there was an error, gives it its name."""
        return self._stack.__exit__(*error)
