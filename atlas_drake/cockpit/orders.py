"""What the page asks of the simulation, and what it gets in return: plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

ACKNOWLEDGED = "acknowledged"
"""What the page answers to a state: the next one may come."""


@dataclass(frozen=True)
class Order:
    """One use of a control."""

    control: str
    values: Mapping[str, Any] = field(default_factory=dict)
    number: int = 0


@dataclass(frozen=True)
class Reply:
    """What became of an order."""

    number: int
    value: Any = None
    problem: str = ""


@dataclass(frozen=True)
class Notice:
    """Something that every viewer is told."""

    text: str
    lasting: bool = False
