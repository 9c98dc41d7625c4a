"""Events of a run: what happened, when, and in which words.

Controllers put them into their status; logs, summaries and listeners read them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from atlas_drake.errors import shown
from atlas_drake.numeric import as_float

STEPS_LEFT = "steps left"
"""Kind of the event for steps that were asked for and not taken."""
FOOTSTEP = "footstep"
"""Kind of the event for a foot that landed."""
FOOTSTEP_DATA = (
    "foot",
    "commanded",
    "saturated",
    "landed",
    "landed_height",
    "error_m",
    "error_rad",
)
"""What the data of such an event has at least, for displays, figures and summary.

That is 0 or 1 for the left or right foot; x, y [m] and yaw [rad] of the sole as it was
sent, as it was aimed for and as it landed; its height [m]; how far off it is, in place
[m] and in heading [rad].
"""


@dataclass(frozen=True)
class Event:
    """Something worth telling the user: printed, logged, written to the summary.

    Attributes:
        time: When [s].
        kind: In one word or two, such as ``fall``, ``footstep``, ``warning``.
        text: For people.
        data: For programs; plain numbers, text, lists. That of a ``FOOTSTEP`` has
            ``FOOTSTEP_DATA``.
    """

    time: float
    kind: str
    text: str
    data: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check what everybody relies on.

        Raises:
            TypeError: If a field is of the wrong type; it names the field.
            ValueError: If the time is not finite, or the data of a footstep lacks some.
        """
        time = as_float(self.time)
        if time is None:
            raise TypeError(f"time of an Event must be a number, is {shown(self.time)}")
        if not math.isfinite(time):
            raise ValueError(f"time of an Event must be finite, is {shown(self.time)}")
        for name in ("kind", "text"):
            value = getattr(self, name)
            if not isinstance(value, str):
                raise TypeError(f"{name} of an Event must be text, is {shown(value)}")
        if not isinstance(self.data, Mapping):
            raise TypeError(f"data of an Event must be a dict, is {shown(self.data)}")
        lacking = [name for name in FOOTSTEP_DATA if name not in self.data]
        if self.kind == FOOTSTEP and lacking:
            raise ValueError(
                f"data of an Event {FOOTSTEP!r} must have "
                f"{', '.join(FOOTSTEP_DATA)}; it lacks {', '.join(lacking)}"
            )

    def __str__(self) -> str:
        """When, and in which words."""
        return f"{self.time:.3f} s: {self.text}"
