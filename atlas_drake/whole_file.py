"""Files that appear under their name when they are whole, or not at all."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any


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
    path = path.resolve()
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        yield path
        return
    token = secrets.token_hex(4)
    unfinished = path.with_name(f".{path.stem}.{token}.unfinished{path.suffix}")
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
