"""Events of a run: what happened, when, and in which words.

Controllers put them into their status; logs, summaries and listeners read them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

STEPS_LEFT = "steps left"
"""Kind of the event for steps that were asked for and not taken."""


@dataclass(frozen=True)
class Event:
    """Something worth telling the user: printed, logged, written to the summary.

    Attributes:
        time: When [s].
        kind: In one word or two, such as ``fall``, ``footstep``, ``warning``.
        text: For people.
        data: For programs; plain numbers, text, lists.
    """

    time: float
    kind: str
    text: str
    data: dict[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        """When, and in which words."""
        return f"{self.time:.3f} s: {self.text}"
