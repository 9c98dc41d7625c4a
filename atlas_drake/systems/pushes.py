"""Pushes of a scenario as data: on what, how hard, where to, and when.

``systems.push_source`` decides when a push is due.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge

from atlas_drake.config import Configuration, NotNegative, Positive, Vector
from atlas_drake.errors import ScenarioError
from atlas_drake.robot import TRUNK
from atlas_drake.units import Newtons, NewtonSeconds, Radians, Ratio, Seconds

LIFT_OFF, TOUCHDOWN = "lift_off", "touchdown"
LARGEST_FORCE = 1e5
"""Largest force along an axis [N]: a hundred times a robot's weight, above which the
physics cannot be solved."""


@dataclass(frozen=True)
class PlannedPush(Configuration):
    """A push on a body of the robot, at a time or at a phase of the gait."""

    impulse: NotNegative[NewtonSeconds] = 0.0
    """Horizontal force times duration."""
    lift: NewtonSeconds = 0.0
    """Upward force times duration; negative is downward."""
    direction: Radians = 0.0
    """Where to, counter-clockwise from x of ``frame``: 0 is forward, π/2 to the
    left."""
    frame: Literal["robot", "world"] = "robot"
    """What the direction is relative to: the heading of the pelvis when the push
    begins, or the world."""
    force_W: Vector[Newtons] | None = None
    """Force in W, in place of impulse, lift and direction; null for these."""
    body: str = TRUNK
    """Name of the link that is pushed at its origin; ``trunk`` is that of the chest on
    every robot."""
    duration: Positive[Seconds] = 0.1
    """How long the force lasts."""
    time: NotNegative[Seconds] | None = None
    """When it begins; null where ``phase`` says so."""
    phase: Literal["", "lift_off", "touchdown"] = ""
    """Begins at this event of the gait, lift_off or touchdown; empty where ``time``
    says when. Events are read from the load on the soles."""
    foot: Literal["any", "left", "right"] = "any"
    """Whose event."""
    count: Annotated[int, Ge(1)] = 1
    """Begins at the count-th such event of the run, from 1."""
    fraction: NotNegative[Ratio] = 0.0
    """Share of the time to the planned touchdown (``t_step_rem`` at that event) after
    which the push begins."""
    delay: NotNegative[Seconds] = 0.0
    """Time after that at which the push begins."""

    def check(self) -> None:
        """Checks the force, and that one beginning is given."""

        def refuse(name: str, wanted: str) -> ScenarioError:
            value = getattr(self, name)
            return ScenarioError.about(name, value, f"must be {wanted}")

        if self.force_W is not None:
            if self.impulse or self.lift or self.direction:
                raise refuse("force_W", "without impulse, lift and direction")
            if max(map(abs, self.force_W)) > LARGEST_FORCE:
                raise refuse("force_W", f"at most {LARGEST_FORCE:g} N along each axis")
        if max(self.impulse, abs(self.lift)) / self.duration > LARGEST_FORCE:
            most = LARGEST_FORCE * self.duration
            raise refuse("impulse", f"at most {most:g} N·s in {self.duration:g} s")
        if (self.time is None) == (not self.phase):
            raise refuse("time", "given, or else phase, and not both")

    def force(self, heading: float) -> list[float]:
        """The force in W [N].

        Args:
            heading: Of the robot's pelvis when the push begins [rad].
        """
        if self.force_W is not None:
            return list(self.force_W)
        angle = self.direction + (heading if self.frame == "robot" else 0.0)
        size, up = self.impulse / self.duration, self.lift / self.duration
        return [size * math.cos(angle), size * math.sin(angle), up]
