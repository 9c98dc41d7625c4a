"""Hides warnings of Drake's log that do not concern this simulation."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager


def is_news(record: logging.LogRecord) -> bool:
    """Filters a record of Drake's logger.

    For every world with a half space Drake warns that deformable bodies cannot touch
    it. This simulation has no deformable bodies.
    """
    return "deformable contact" not in record.getMessage()


@contextmanager
def only_news() -> Iterator[None]:
    """Hides irrelevant warnings of Drake's log within a ``with`` block."""
    logger = logging.getLogger("drake")
    logger.addFilter(is_news)
    try:
        yield
    finally:
        logger.removeFilter(is_news)
