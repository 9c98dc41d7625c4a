"""Pushes of a scenario as data: on what, how hard, where to, and when.

``systems.push_source`` decides when a push is due.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from atlas_drake.errors import ScenarioError, shown

LIFT_OFF, TOUCHDOWN = "lift_off", "touchdown"
PHASES = (LIFT_OFF, TOUCHDOWN)
FEET = ("any", "left", "right")
FRAMES = ("robot", "world")
LARGEST_FORCE = 1e5
"""Largest force along an axis [N]: a hundred times a robot's weight, above which the
physics cannot be solved."""


@dataclass
class PlannedPush:
    """A horizontal push on a body of the robot, at a time or at a phase of the gait."""

    impulse: float = 0.0
    """Force times duration [N·s]."""
    direction: float = 0.0
    """Where to, counter-clockwise from x of ``frame`` [rad]: 0 is forward, π/2 to the
    left."""
    frame: str = "robot"
    """What the direction is relative to: the heading of the pelvis when the push
    begins, or the world; one of FRAMES."""
    body: str = ""
    """Name of the link that is pushed at its origin; empty for the chest."""
    duration: float = 0.1
    """How long the force lasts [s]."""
    time: float | None = None
    """When it begins [s]; null where ``phase`` says so."""
    phase: str = ""
    """Begins at this event of the gait, lift_off or touchdown; empty where ``time``
    says when. Events are read from the load on the soles."""
    foot: str = "any"
    """Whose event, one of FEET."""
    count: int = 1
    """Begins at the count-th such event of the run, from 1."""
    fraction: float = 0.0
    """Of the time from that event to the next touchdown, as the behavior plans it then
    (``t_step_rem``), that passes before the push begins [-]."""
    delay: float = 0.0
    """Time that passes besides [s]."""

    def validate(self, path: str) -> None:
        """Checks every field.

        Args:
            path: Of this entry in the scenario.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """

        def refuse(name: str, wanted: str) -> ScenarioError:
            value = getattr(self, name)
            return ScenarioError(
                f"{path}.{name}", value, f"is {shown(value)}; must be {wanted}"
            )

        for name, words in (("frame", FRAMES), ("foot", FEET), ("phase", PHASES)):
            value = getattr(self, name)
            if value not in words and (name, value) != ("phase", ""):
                raise refuse(name, f"one of {', '.join(words)}")
        for name in ("impulse", "fraction", "delay"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise refuse(name, "a number not below 0")
        if not math.isfinite(self.direction):
            raise refuse("direction", "a number")
        if not (math.isfinite(self.duration) and self.duration > 0.0):
            raise refuse("duration", "a positive number")
        if self.impulse / self.duration > LARGEST_FORCE:
            most = LARGEST_FORCE * self.duration
            raise refuse("impulse", f"at most {most:g} N·s in {self.duration:g} s")
        if self.count < 1:
            raise refuse("count", "1 or more")
        if (self.time is None) == (not self.phase):
            raise refuse("time", "given, or else phase, and not both")
        if self.time is not None and not (math.isfinite(self.time) and self.time >= 0):
            raise refuse("time", "a number not below 0")

    def force(self, heading: float) -> list[float]:
        """The force in W [N].

        Args:
            heading: Of the robot's pelvis when the push begins [rad].
        """
        angle = self.direction + (heading if self.frame == "robot" else 0.0)
        size = self.impulse / self.duration
        return [size * math.cos(angle), size * math.sin(angle), 0.0]
