"""What of Drake's log is no news to anybody who simulates Atlas."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager


def is_news(record: logging.LogRecord) -> bool:
    """A filter for Drake's logger.

    Drake warns whenever a world with a half space begins that nothing deformable can
    touch it. Nothing here is deformable.
    """
    return "deformable contact" not in record.getMessage()


@contextmanager
def only_news() -> Iterator[None]:
    """Keeps from Drake's log, for as long as it lasts, what is no news."""
    logger = logging.getLogger("drake")
    logger.addFilter(is_news)
    try:
        yield
    finally:
        logger.removeFilter(is_news)
