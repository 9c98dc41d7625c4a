"""Files that appear under their name when they are whole, or not at all.

And whether one can be written there, asked before there is anything to write.
"""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any


def why_not_writable(path: Path) -> str | None:
    """What keeps a file from being written there; None if nothing is known to."""
    try:
        folder = path.parent
        if path.is_dir():
            return f"{path} is a folder"
        if not folder.is_dir():
            return f"there is no folder {folder}"
        # A file is replaced by a new one when that is whole; a device is written to.
        ends = [path] if path.exists() else []
        if not ends or path.is_file():
            ends.append(_resolved(path).parent)
    except OSError as error:
        return f"{path} cannot be written: {error.strerror}"
    if not all(os.access(end, os.W_OK) for end in ends):
        return f"{path} cannot be written"
    return None


def _resolved(path: Path) -> Path:
    """The path without links.

    Raises:
        OSError: Of links that go in a circle.
    """
    try:
        target = path.resolve()
    except RuntimeError as error:
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path)) from error
    if target.is_symlink():  # Python 3.13 and later leave a circle as it is.
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return target


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Gives a path to write to, whose file becomes ``path`` unless an error comes.

    The unfinished file is this call's own: two programs that write one ``path`` do not
    meet in it, and the one that ends last stays. A ``path`` that is a device or a pipe
    is written to directly.

    Raises:
        OSError: If no file can be made there.
    """
    # A link stays one, and what it points to is written.
    path = _resolved(path)
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        yield path
        return
    token = secrets.token_hex(4)
    # Not of its stem as well: names have a greatest length.
    unfinished = path.with_name(f".{token}.unfinished{path.suffix}")
    # Fails where anything is already, also a link that leads elsewhere.
    os.close(os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
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

    def abandon(self) -> None:
        """Closes and deletes the unfinished file; does nothing after the end."""
        error = OSError("abandoned")
        with suppress(OSError):
            self._stack.__exit__(type(error), error, None)
