"""Lists of what happened last, which drop nothing before it can be read.

For frozen values in a Context, which are read from time to time.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

READ_WITHIN = 0.1
"""Time within which every reader looks [s]: several times the longest control period,
and several chunks of a simulation."""


class Timed(Protocol):
    """Something that happened at a time."""

    @property
    def time(self) -> float:
        """When [s]."""


_T = TypeVar("_T")
_Timed = TypeVar("_Timed", bound=Timed)


def append_recent(
    items: tuple[_Timed, ...], item: _Timed, kept: int
) -> tuple[_Timed, ...]:
    """Append an item, and drop the oldest ones beyond ``kept``.

    However many there are, none is dropped that is younger than ``READ_WITHIN``.
    """
    drop = 0
    while len(items) - drop >= kept and items[drop].time < item.time - READ_WITHIN:
        drop += 1
    return (*items[drop:], item)


def items_since(items: tuple[_T, ...], total: int, seen: int) -> tuple[_T, ...]:
    """Return what came after the first ``seen`` items.

    Args:
        items: The latest ones, oldest first.
        total: How many there have been in all.
        seen: How many the reader has had.
    """
    count = total - seen
    return items[-count:] if count > 0 else ()
