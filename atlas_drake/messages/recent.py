"""Bounded lists of recent items that keep each item until it can be read.

For frozen values in a Context, which readers poll.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

READ_WITHIN = 0.1
"""Longest time between two reads of any reader [s]: several times the longest control
period, and several chunks of a simulation."""


class Timed(Protocol):
    """An item with a time."""

    @property
    def time(self) -> float:
        """Time of the item [s]."""


_T = TypeVar("_T")
_Timed = TypeVar("_Timed", bound=Timed)


def append_recent(
    items: tuple[_Timed, ...], item: _Timed, kept: int
) -> tuple[_Timed, ...]:
    """Append an item, and drop the oldest items beyond ``kept``.

    Items younger than ``READ_WITHIN`` are never dropped.
    """
    drop = 0
    while len(items) - drop >= kept and items[drop].time < item.time - READ_WITHIN:
        drop += 1
    return (*items[drop:], item)


def items_since(items: tuple[_T, ...], total: int, seen: int) -> tuple[_T, ...]:
    """Return the items after the first ``seen`` ones.

    Args:
        items: The latest items, oldest first.
        total: Number of all items so far.
        seen: Number of items that the reader has already read.
    """
    count = total - seen
    return items[-count:] if count > 0 else ()
