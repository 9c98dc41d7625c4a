"""Limits Drake's warnings about a URDF to one of each kind.

A robot is parsed for every plant that models it, and an element that Drake does not
know often occurs once per joint.
"""

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager

_LINE = re.compile(r":\d+:")
"""A line's number, after the file's name."""


class _EachKindOnce(logging.Filter):
    """Passes the first warning of each file and wording; the line does not count."""

    def __init__(self) -> None:
        super().__init__()
        self._seen: set[str] = set()

    def filter(self, record: logging.LogRecord) -> bool:
        kind = _LINE.sub(":", record.getMessage(), count=1)
        if record.levelno > logging.WARNING or kind not in self._seen:
            self._seen.add(kind)
            return True
        return False


_once = _EachKindOnce()


@contextmanager
def each_warning_once() -> Iterator[None]:
    """Drops warnings like earlier ones of this process while a file is parsed."""
    logger = logging.getLogger("drake")
    logger.addFilter(_once)
    try:
        yield
    finally:
        logger.removeFilter(_once)
