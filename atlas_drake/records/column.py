"""What a number of a record means: unit, labels, description; beside its field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum
from functools import cache
from typing import Any, get_type_hints

import numpy as np

from atlas_drake.frozen import Frozen
from atlas_drake.messages.base import same_fields

XY, XYZ = ("x", "y"), ("x", "y", "z")
WXYZ = ("w", "x", "y", "z")


class Names(Enum):
    """Labels that depend on the robot and its world, in message or plant order.

    Those of ``CONTACT_PAIRS`` are in the order of the scenario, x, y and z for each.
    """

    JOINTS = "joints"
    POSITIONS = "positions"
    VELOCITIES = "velocities"
    WORLD_POSITIONS = "world positions"
    WORLD_VELOCITIES = "world velocities"
    CONTACT_PAIRS = "contact pairs"


@dataclass(frozen=True)
class Column:
    """Annotation of a field that holds a number, or an array of numbers."""

    about: str = ""
    unit: str = ""  # Empty for counts, flags and ratios.
    labels: tuple[str, ...] | Names = ()  # None for a single number.
    kind: str = "f8"  # Numpy's name of the data type in a log.
    optional: bool = False  # True if the field may be None; a log then has NaN.
    width: int = 0  # Numbers per row, of up to as many rows as the labels have.

    @property
    def elements(self) -> tuple[str, ...]:
        """Labels of a column of a schema, where the robot's are known."""
        assert isinstance(self.labels, tuple)
        return self.labels

    def numbers(self, value: Any, size: int) -> list[float | None]:
        """Returns the numbers of an array, one per label; None where missing."""
        if value is None:
            return [None] * size
        numbers = np.asarray(value).ravel().tolist()
        return numbers + [None] * (size - len(numbers))

    def value(self, numbers: np.ndarray) -> Any:
        """Returns the field's value from its numbers; the reverse of ``numbers``."""
        if self.optional and np.isnan(numbers).all():
            return None
        if not self.labels:
            number = numbers.item()
            return number if self.kind.startswith("f") else int(number)
        if self.width:
            rows = numbers.reshape(-1, self.width)
            numbers = rows[~np.isnan(rows).all(axis=1)]
        array = np.array(numbers, dtype=float)
        array.setflags(write=False)
        return array


class Group(Frozen):
    """Base of records and their parts: dataclasses whose fields may be columns.

    Two of them are equal if all numbers are equal; NaN equals NaN.
    """

    @classmethod
    def columns(cls) -> Mapping[str, Column]:
        """Returns the columns by field."""
        return _columns(cls)  # type: ignore[arg-type]

    def __eq__(self, other: object) -> bool:
        """Compares all fields that take part in comparisons."""
        if type(other) is not type(self):
            return NotImplemented
        return same_fields(self, other)

    __hash__ = None  # type: ignore[assignment]


@cache
def _columns(group: Any) -> Mapping[str, Column]:
    hints = get_type_hints(group, include_extras=True)
    return {
        field.name: column
        for field in fields(group)
        for column in getattr(hints[field.name], "__metadata__", ())
        if isinstance(column, Column)
    }
