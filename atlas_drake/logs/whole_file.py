"""Files that appear under their name when they are whole, or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def unfinished_path(path: Path) -> Path:
    """Where a file is written that shall appear under ``path`` when it is whole."""
    return path.with_name(f".{path.stem}.unfinished{path.suffix}")


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Gives a path to write to, whose file becomes ``path`` unless an error comes."""
    unfinished = unfinished_path(path)
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
