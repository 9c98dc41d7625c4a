"""Layout of a log's row: channels with names and units, and their places.

The list of channels is in ``channels``; the format files write rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

XY, XYZ = ("x", "y"), ("x", "y", "z")
WXYZ = ("w", "x", "y", "z")
SIDES = ("left", "right")


@dataclass(frozen=True)
class Channel:
    """One quantity.

    Attributes:
        name: ``topic.field``, or a single word.
        unit: Unit of all elements; empty for counts, flags and ratios.
        labels: Labels of the elements; none for a single number.
        kind: Numpy's name of the data type in the log.
        about: Description of the quantity.
    """

    name: str
    unit: str = ""
    labels: tuple[str, ...] = ()
    kind: str = "f8"
    about: str = ""

    @property
    def size(self) -> int:
        """Number of elements."""
        return max(len(self.labels), 1)


class Layout:
    """The channels of a log and where each lies in a row.

    Attributes:
        channels: The channels in order.
        places: Slice of a row for each channel's name.
        width: Length of a row.
    """

    def __init__(self, channels: Iterable[Channel]):
        self.channels = tuple(channels)
        self.places: dict[str, slice] = {}
        self.width = 0
        for channel in self.channels:
            self.places[channel.name] = slice(self.width, self.width + channel.size)
            self.width += channel.size

    def split(self, table: np.ndarray) -> dict[str, np.ndarray]:
        """Arrays of the channels, by name.

        Args:
            table: Rows, shape (number of rows, width).

        Returns:
            Arrays of shape (number of rows,), or (number of rows, size) for channels
            with labels.
        """
        arrays = {}
        for channel in self.channels:
            part = table[:, self.places[channel.name]].astype(channel.kind)
            arrays[channel.name] = part if channel.labels else part[:, 0]
        return arrays

    def columns(self) -> list[str]:
        """A name for each number of a row."""
        return [
            f"{channel.name}.{label}" if label else channel.name
            for channel in self.channels
            for label in (channel.labels or ("",))
        ]

    def to_plain(self) -> list[dict[str, Any]]:
        """The channels as plain data."""
        return [asdict(channel) for channel in self.channels]

    @classmethod
    def from_plain(cls, plain: Iterable[Mapping[str, Any]]) -> Layout:
        """The reverse of ``to_plain``."""
        return cls(
            Channel(**{**entry, "labels": tuple(entry["labels"])}) for entry in plain
        )
