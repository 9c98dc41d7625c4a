"""A learned policy that commands joints of a run, as a scenario names it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Interval, Len

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.errors import ScenarioError
from atlas_drake.units import Ratio, Seconds

LARGEST = 10.0
"""Largest velocity that a scenario may ask for [m/s, rad/s]."""
STICK = (0.8, 0.4, 0.8)
"""Usual velocity that a stick asks for at its end: ahead, left [m/s], turn [rad/s]."""
Velocity = Annotated[
    list[Annotated[Ratio, Interval(ge=-LARGEST, le=LARGEST)]], Len(3, 3)
]
"""Desired velocity: ahead, to the left [m/s], and of turning [rad/s]."""


@dataclass(frozen=True)
class PolicyUse(Configuration):
    """A policy in the place of a person who commands joints."""

    file: str = ""
    """ONNX file with its exporter's metadata, or a description in YAML, relative as
    ``model``."""
    joints: list[str] = field(default_factory=list)
    """Its joints in its own order, where the file does not name them."""
    velocity: Velocity = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Velocity that it is asked for at first: ahead, left [m/s], turn [rad/s]."""
    fastest: Velocity = field(default_factory=lambda: [*STICK])
    """Velocity that keys and sticks of the cockpit ask for at their ends, likewise."""
    start: NotNegative[Seconds] = 0.3
    """Time at which it takes its joints; the robot stands by then."""
    watchdog: bool = False
    """True if STAND takes the joints back when the policy's commands are late, no
    numbers, or far beyond a joint's stop."""

    def check(self) -> None:
        """Checks that there is a policy."""
        if not self.file:
            raise ScenarioError("file", self.file, "is missing")
