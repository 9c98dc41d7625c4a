"""What the page asks of the simulation, and what it gets in return: plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

ACKNOWLEDGED = "acknowledged"
"""What the page answers to a state: the next one may come."""


@dataclass(frozen=True)
class Order:
    """One use of a control.

    Attributes:
        control: Group and name, such as ``walk.steer``.
        values: Arguments by name.
        number: Number of the order, for the reply.
    """

    control: str
    values: Mapping[str, Any] = field(default_factory=dict)
    number: int = 0


@dataclass(frozen=True)
class Reply:
    """What became of an order.

    Attributes:
        number: Number of the order.
        value: What the control returned.
        problem: Why it was refused; empty if it was not.
    """

    number: int
    value: Any = None
    problem: str = ""


@dataclass(frozen=True)
class Notice:
    """Something that every viewer is told.

    Attributes:
        text: What it is.
        lasting: True if the page goes on to show it beside the scenario.
    """

    text: str
    lasting: bool = False
