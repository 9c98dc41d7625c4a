"""The schema of a run's records: every column with its labels, by name.

The columns stand beside the fields of the records; only the labels depend on the robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import NoneType, UnionType
from typing import Any, get_args, get_type_hints

import numpy as np

from atlas_drake.config import Configuration, checked
from atlas_drake.errors import ScenarioError
from atlas_drake.frozen import Frozen
from atlas_drake.records.column import Column, Group, Names
from atlas_drake.records.tick_record import TickRecord

TIME = "time"
"""The column that belongs to no group."""


def _groups() -> dict[str, type[Group]]:
    """Finds the groups of a record, by the name of their field."""
    found: dict[str, type[Group]] = {}
    for name, hint in get_type_hints(TickRecord).items():
        for kind in get_args(hint) if isinstance(hint, UnionType) else (hint,):
            if isinstance(kind, type) and issubclass(kind, Group):
                found[name] = kind
    return found


GROUPS = _groups()
"""Classes of the groups of numbers in a record, by field."""
OPTIONAL = frozenset(
    name
    for name, hint in get_type_hints(TickRecord).items()
    if name in GROUPS and NoneType in get_args(hint)
)
"""Groups that not every run has."""


@dataclass(frozen=True)
class Schema(Frozen):
    """Columns of the records of a run: labels of its robot, and groups by name."""

    names: Mapping[Names, tuple[str, ...]]
    groups: tuple[str, ...]

    @cached_property
    def columns(self) -> dict[str, Column]:
        """All columns with their labels, by name such as ``balance.dcm``."""
        found = {TIME: TickRecord.columns()[TIME]}
        for group, part in self.parts.items():
            found |= {f"{group}.{name}": column for name, column in part.items()}
        return found

    @cached_property
    def parts(self) -> dict[str, dict[str, Column]]:
        """The columns of each group, by field."""
        return {
            group: {
                name: self._labelled(column)
                for name, column in GROUPS[group].columns().items()
            }
            for group in self.groups
        }

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of all numbers but the time, by name such as ``balance.dcm.x``."""
        return {
            f"{name}.{label}".rstrip("."): column.unit
            for name, column in self.columns.items()
            if name != TIME
            for label in column.elements or ("",)
        }

    def _labelled(self, column: Column) -> Column:
        if isinstance(column.labels, Names):
            return replace(column, labels=self.names[column.labels])
        return column

    def plain(self, group: str, value: Group) -> dict[str, Any]:
        """Returns a group as plain numbers by field, and by label."""
        found: dict[str, Any] = {}
        for name, column in self.parts[group].items():
            found[name] = getattr(value, name)
            if labels := column.elements:
                numbers = column.numbers(found[name], len(labels))
                found[name] = dict(zip(labels, numbers, strict=True))
        return found

    def group_at(self, group: str, row: Mapping[str, np.ndarray]) -> Group:
        """Makes a group from the numbers of its columns, by column name."""
        return GROUPS[group](
            **{
                name: column.value(row[f"{group}.{name}"])
                for name, column in self.parts[group].items()
            }
        )

    def to_plain(self) -> dict[str, Any]:
        """Returns the schema as plain data."""
        return {
            "names": {key.value: list(labels) for key, labels in self.names.items()},
            "groups": list(self.groups),
        }

    @classmethod
    def from_plain(cls, plain: Any) -> Schema:
        """The reverse of ``to_plain``; raises a ScenarioError for other data."""
        given = checked(_PlainSchema, plain, "schema")
        names = {Names(key): tuple(labels) for key, labels in given.names.items()}
        return cls(names, tuple(given.groups))


@dataclass(frozen=True, kw_only=True)
class _PlainSchema(Configuration):
    """A schema as plain data."""

    names: dict[str, list[str]]
    groups: list[str]

    def check(self) -> None:
        """Checks that all labels are there, and all groups known."""
        if self.names.keys() != {key.value for key in Names}:
            rule = f"must be {', '.join(key.value for key in Names)}"
            raise ScenarioError.about("names", list(self.names), rule)
        for index, group in enumerate(self.groups):
            if group not in GROUPS:
                rule = f"must be one of {', '.join(GROUPS)}"
                raise ScenarioError.about(f"groups[{index}]", group, rule)
