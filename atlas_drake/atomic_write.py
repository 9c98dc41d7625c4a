"""Files: what can be read and written, and names only for what is complete."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def why_not_readable(path: Path) -> str | None:
    """Returns the reason why ``path`` is no file to read, or None.

    A pipe or a device is none: its end may never come.
    """
    try:
        if path.is_file():
            return None
        if path.is_dir():
            return "is a folder"
        return "is no regular file" if path.exists() else "there is no such file"
    except (OSError, ValueError) as error:  # A name too long, or with a NUL.
        return getattr(error, "strerror", None) or str(error)


def why_not_writable(path: Path) -> str | None:
    """Returns the reason why a file cannot be written at ``path``, or None."""
    try:
        if path.is_dir():
            return f"{path} is a folder"
        if not path.parent.is_dir():
            return f"there is no folder {path.parent}"
        # A file is replaced by the complete new one; a device is written to directly.
        ends = [path] if path.exists() else []
        if not ends or path.is_file():
            ends.append(_resolved(path).parent)
    except OSError as error:
        return f"{path} cannot be written: {error.strerror}"
    if not all(os.access(end, os.W_OK) for end in ends):
        return f"{path} cannot be written"
    return None


def _resolved(path: Path) -> Path:
    """Resolves the links of a path; raises OSError if they form a circle."""
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return target


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yields a path to write to, whose file becomes ``path`` if no error is raised.

    The content is on the disk before the file gets its name. The target of a link is
    written; a device or a pipe is written to directly.

    Args:
        path: The file.

    Raises:
        OSError: If the file cannot be made.
    """
    path = _resolved(path)
    if path.exists() and not (path.is_file() or path.is_dir()):
        yield path
        return
    # Without the stem of the path, because the length of names is limited.
    token = secrets.token_hex(4)
    unfinished = path.with_name(f".{token}.unfinished{path.suffix}")
    # Fails for a link, and if it exists.
    os.close(os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    try:
        yield unfinished
        # Otherwise a power failure can leave the name with an empty file.
        with unfinished.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
